#include "mindahl/report/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "report/adequacy.h"
#include "report/names.h"
#include "report/requirements.h"

namespace mindahl::report {

using identification::FitResult;
using identification::Identifiability;
using identification::ParameterEstimate;
using io::PlotStyle;

namespace {

struct LengthAxis {
  const char* unit;
  double per_metre;
};

/// The unit in which an extent has a number between 1 and 1000, as far as there is one.
LengthAxis AxisFor(double extent, bool is_angle) {
  if (is_angle) {
    if (extent < 1e-3) return {"µrad", 1e6};
    if (extent < 1) return {"mrad", 1e3};
    return {"rad", 1.0};
  }
  if (extent < 1e-6) return {"nm", 1e9};
  if (extent < 1e-3) return {"µm", 1e6};
  if (extent < 1) return {"mm", 1e3};
  return {"m", 1.0};
}

bool IsUnderLoad(const Report& report, const loop::Record& record, std::size_t sample) {
  if (!report.load_window) return true;
  const double load = record.normal_load[sample];
  return load >= report.load_window->lower && load <= report.load_window->upper;
}

/// A parameter by its sign: no number of what is not known.
std::string ParameterText(const char* sign, const ParameterEstimate& estimate) {
  const std::string unit = estimate.unit == "-" ? "" : " " + estimate.unit;
  if (estimate.is_known()) {
    return fmt::format("{} = {:.4g}{}", sign, estimate.value, unit);
  }
  if (estimate.identifiability == Identifiability::kBoundedBelow && estimate.lower95) {
    return fmt::format("{} > {:.3g}{}", sign, *estimate.lower95, unit);
  }
  return fmt::format("{} not known", sign);
}

std::string TitleOf(const Report& report) {
  const FitResult& fit = report.fit;
  return fmt::format("{}, {}: {}, {}, {}", fit.model->name,
                     IsJudged(report) ? Name(fit.adequacy.verdict) : std::string_view("not judged"),
                     ParameterText("σ", *fit.Find("sigma")), ParameterText("α", *fit.Find("alpha")),
                     ParameterText("Tc", *fit.Find("slip_force")));
}

/// σ or Tc against the load: of the whole series a line, of each file alone an interval.
struct LoadPanel {
  std::string label;
  double scale;  // of what is drawn over SI
  identification::ParameterEstimate identification::RecordAlone::*alone;
  bool is_stiffness;
};

io::PlotPanel PanelOverLoad(const Report& report, const LoadPanel& quantity) {
  const FitResult& fit = report.fit;
  io::PlotPanel panel{.x_label = quantity.is_stiffness ? "" : "normal load N [N]",
                      .y_label = quantity.label,
                      .series = {},
                      .height = 1.2};
  double least = report.load_series->contacts.front().normal_load;
  double greatest = least;
  io::PlotSeries alone;
  alone.label = "each file alone, 95 %";
  alone.style = PlotStyle::kIntervals;
  for (const ContactUnderLoad& contact : report.load_series->contacts) {
    least = std::min(least, contact.normal_load);
    greatest = std::max(greatest, contact.normal_load);
    if (!contact.alone) continue;
    const ParameterEstimate& estimate = (*contact.alone).*quantity.alone;
    if (!estimate.lower95 || !estimate.upper95) continue;
    alone.x.push_back(contact.normal_load);
    alone.y.push_back(quantity.scale * estimate.value);
    alone.lower.push_back(quantity.scale * *estimate.lower95);
    alone.upper.push_back(quantity.scale * *estimate.upper95);
  }
  constexpr int kSteps = 60;
  io::PlotSeries line;
  line.label = quantity.is_stiffness ? fmt::format("σ ∝ N^{:.3g}, the series", fit.load_exponent)
                                     : std::string("Tc = μN, the series");
  for (int i = 0; i <= kSteps; ++i) {
    const double load = least + (greatest - least) * i / kSteps;
    const double ratio = load / *fit.normal_load;
    line.x.push_back(load);
    const double value = quantity.is_stiffness
                             ? fit.law.tangential_stiffness * std::pow(ratio, fit.load_exponent)
                             : fit.law.slip_force * ratio;
    line.y.push_back(quantity.scale * value);
  }
  panel.series.push_back(std::move(line));
  if (!alone.x.empty()) panel.series.push_back(std::move(alone));
  return panel;
}

}  // namespace

io::Plot ToPlot(const Report& report) {
  RequireFitted(report, "a figure");
  io::Plot plot;
  plot.title = TitleOf(report);
  double extent = 0.0;
  for (const identification::RecordFit& fit : report.fit.records) {
    extent = std::max(extent, std::abs(fit.measures.centre) + fit.measures.amplitude);
  }
  const LengthAxis axis = AxisFor(extent, report.is_torsional());
  const auto scaled = [&axis](std::vector<double> values) {
    for (double& value : values) value *= axis.per_metre;
    return values;
  };
  io::PlotPanel loop{.x_label = "",
                     .y_label = fmt::format("{} [{}]", report.is_torsional() ? "torque" : "force",
                                            report.units.force),
                     .series = {},
                     .height = 2.5};
  io::PlotPanel residual{
      .x_label =
          fmt::format("{} [{}]", report.is_torsional() ? "angle" : "displacement", axis.unit),
      .y_label = fmt::format("fitted − measured [{}]", report.units.force),
      .series = {}};
  for (std::size_t r = 0; r < report.fit.records.size(); ++r) {
    const identification::RecordFit& fit = report.fit.records[r];
    const loop::Record& record = report.records[r].record;
    const std::string suffix =
        report.files.size() > 1 ? fmt::format(" {}", report.files[r]) : std::string();
    loop.series.push_back(
        {"measured" + suffix, scaled(record.displacement), record.force, PlotStyle::kPoints});
    loop.series.push_back(
        {"fitted" + suffix, scaled(record.displacement), fit.fitted_force, PlotStyle::kLine});
    // What the load window leaves out would squeeze the rest together.
    io::PlotSeries& shown =
        residual.series.emplace_back(io::PlotSeries{"", {}, {}, PlotStyle::kPoints});
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (!IsUnderLoad(report, record, i)) continue;
      shown.x.push_back(axis.per_metre * record.displacement[i]);
      shown.y.push_back(fit.residual[i]);
    }
  }
  io::PlotSeries reversals{"reversals", {}, {}, PlotStyle::kMarkers};
  for (std::size_t r = 0; r < report.fit.records.size(); ++r) {
    const loop::Record& record = report.records[r].record;
    for (const std::size_t sample : report.fit.records[r].reversals) {
      reversals.x.push_back(axis.per_metre * record.displacement[sample]);
      reversals.y.push_back(record.force[sample]);
    }
  }
  if (!reversals.x.empty()) loop.series.push_back(std::move(reversals));
  plot.panels = {std::move(loop), std::move(residual)};
  if (report.load_series) {
    constexpr int kTaller = 400;  // [px]
    plot.height += kTaller;
    plot.panels.push_back(PanelOverLoad(
        report, {fmt::format("σ [{}/{}]", report.units.force, axis.unit), 1 / axis.per_metre,
                 &identification::RecordAlone::stiffness, /*is_stiffness=*/true}));
    plot.panels.push_back(
        PanelOverLoad(report, {fmt::format("Tc [{}]", report.units.force), 1.0,
                               &identification::RecordAlone::slip_force, /*is_stiffness=*/false}));
  }
  return plot;
}

}  // namespace mindahl::report
