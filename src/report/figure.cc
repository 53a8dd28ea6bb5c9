#include "mindahl/report/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "report/requirements.h"

namespace mindahl::report {

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

}  // namespace

io::Plot ToPlot(const Report& report) {
  RequireFitted(report, "a figure");
  io::Plot plot;
  const ParameterEstimate& sigma = *report.fit.Find("sigma");
  const ParameterEstimate& alpha = *report.fit.Find("alpha");
  const ParameterEstimate& slip_force = *report.fit.Find("slip_force");
  plot.title = fmt::format("{}: σ = {:.4g} {}, α = {:.4g}, Tc = {:.4g} {}", report.fit.model->name,
                           sigma.value, report.units.stiffness, alpha.value, slip_force.value,
                           report.units.force);
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
  plot.panels = {std::move(loop), std::move(residual)};
  return plot;
}

}  // namespace mindahl::report
