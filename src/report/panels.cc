#include "report/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "mindahl/report/report.h"
#include "mindahl/report/units.h"
#include "report/names.h"
#include "report/statements.h"

namespace mindahl::report {

using identification::AdequacyVerdict;
using identification::ParameterEstimate;
using identification::RecordFit;
using io::PlotPanel;
using io::PlotSeries;
using io::PlotStyle;

namespace {

constexpr double kDataShade = 0.3;  // of what is measured, where it is of one kind
constexpr std::size_t kMostGroups = 8;

/// Returns how often the prefixed unit goes into the plain one: 10⁶ of µm, to the last bit.
double Per(const ScaledUnit& unit) {
  return unit.factor < 1 ? std::round(1 / unit.factor) : 1 / unit.factor;
}

bool IsUnderLoad(const Report& report, const loop::Record& record, std::size_t sample) {
  if (!report.load_window) return true;
  const double load = record.normal_load[sample];
  return load >= report.load_window->lower && load <= report.load_window->upper;
}

bool Counts(const RecordFit& fit, std::size_t sample) {
  return fit.counts.empty() || fit.counts[sample] != 0;
}

std::vector<double> CountedResiduals(const RecordFit& fit) {
  std::vector<double> residuals;
  for (std::size_t i = 0; i < fit.residual.size(); ++i) {
    if (Counts(fit, i)) residuals.push_back(fit.residual[i]);
  }
  return residuals;
}

std::vector<double> CountedResiduals(const Report& report) {
  std::vector<double> residuals;
  for (const RecordFit& fit : report.fit.records) {
    const std::vector<double> more = CountedResiduals(fit);
    residuals.insert(residuals.end(), more.begin(), more.end());
  }
  return residuals;
}

std::string ForceName(const Report& report) { return report.is_torsional() ? "torque" : "force"; }

std::string DisplacementLabel(const Report& report, const PanelUnits& units) {
  return fmt::format("{} [{}]", report.is_torsional() ? "angle" : "displacement",
                     units.displacement.name);
}

std::string ResidualLabel(const PanelUnits& units) {
  return fmt::format("fitted − measured [{}]", units.residual.name);
}

/// Samples that are drawn alike: of a record, or of some of its cycles in a row.
struct Group {
  std::string label;
  std::optional<double> shade = kDataShade;
  std::size_t record = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Returns, by cycle, the cycles of a record that is alone, as many in a row as make eight groups
/// at most; otherwise the records. A cycle begins at every second reversal.
std::vector<Group> GroupsOf(const Report& report, const std::string& what, LoopColours colours) {
  std::vector<Group> groups;
  const std::size_t records = report.records.size();
  const bool by_cycle = colours == LoopColours::kByCycle;
  if (records > 1 || !by_cycle) {
    for (std::size_t r = 0; r < records; ++r) {
      Group& group = groups.emplace_back();
      group.shade.reset();
      group.record = r;
      group.end = report.records[r].record.size();
      // A legend of many files would be longer than the page.
      const bool is_named = !by_cycle || records <= kMostGroups || r == 0 || r + 1 == records;
      if (is_named) group.label = records > 1 ? fmt::format("{} {}", what, report.files[r]) : what;
      if (by_cycle) group.shade = static_cast<double>(r) / static_cast<double>(records - 1);
    }
    return groups;
  }
  const std::vector<std::size_t>& reversals = report.fit.records.front().reversals;
  std::vector<std::size_t> starts = {0};
  for (std::size_t k = 2; k < reversals.size(); k += 2) starts.push_back(reversals[k]);
  const std::size_t samples = report.records.front().record.size();
  if (starts.size() > 1 && starts.back() + 1 >= samples) starts.pop_back();
  const std::size_t cycles = starts.size();
  const std::size_t count = std::min(cycles, kMostGroups);
  for (std::size_t g = 0; g < count; ++g) {
    const std::size_t first = g * cycles / count;
    const std::size_t next = (g + 1) * cycles / count;
    Group group{.label = what,
                .shade = kDataShade,
                .record = 0,
                .begin = starts[first],
                .end = next < cycles ? starts[next] : samples};
    if (cycles > 1) {
      group.shade = static_cast<double>(g) / static_cast<double>(count - 1);
      group.label = next == first + 1 ? fmt::format("{}, cycle {}", what, first + 1)
                                      : fmt::format("{}, cycles {} to {}", what, first + 1, next);
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

PlotSeries Range(const Group& group, const std::vector<double>& x, double per_x,
                 const std::vector<double>& y, double per_y) {
  PlotSeries series{.label = group.label, .style = PlotStyle::kPoints, .shade = group.shade};
  for (std::size_t i = group.begin; i < group.end; ++i) {
    series.x.push_back(per_x * x[i]);
    series.y.push_back(per_y * y[i]);
  }
  return series;
}

/// Returns the fitted displacements, or the measured ones where the force was fitted.
const std::vector<double>& FittedDisplacement(const Report& report, std::size_t r) {
  const std::vector<double>& fitted = report.fit.records[r].fitted_displacement;
  return fitted.empty() ? report.records[r].record.displacement : fitted;
}

/// The fitted loop of a record; of one that is too long to be drawn whole, of its last cycle.
PlotSeries FittedLine(const Report& report, std::size_t r, const PanelUnits& units,
                      std::size_t most_samples) {
  const RecordFit& fit = report.fit.records[r];
  Group range{.label = "fitted", .record = r, .begin = 0, .end = fit.fitted_force.size()};
  const std::vector<std::size_t>& reversals = fit.reversals;
  if (range.end > most_samples && reversals.size() >= 3) {
    range.begin = reversals[reversals.size() - 3];
    range.end = reversals.back() + 1;
    range.label += ", last cycle";
  }
  PlotSeries series = Range(range, FittedDisplacement(report, r), Per(units.displacement),
                            fit.fitted_force, Per(units.force));
  series.style = PlotStyle::kLine;
  series.shade.reset();
  return series;
}

/// Draws the residuals of the samples that have a place.
/// @param place  of a sample of a record on the axis, empty where it is not shown
PlotPanel Residuals(
    const Report& report, const PanelUnits& units, std::string x_label, LoopColours colours,
    const std::function<std::optional<double>(std::size_t record, std::size_t sample)>& place) {
  PlotPanel panel{.x_label = std::move(x_label), .y_label = ResidualLabel(units)};
  for (const Group& group : GroupsOf(report, "", colours)) {
    PlotSeries shown{.label = "", .style = PlotStyle::kPoints, .shade = group.shade};
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const std::optional<double> x = place(group.record, i);
      if (!x) continue;
      shown.x.push_back(*x);
      shown.y.push_back(Per(units.residual) * report.fit.records[group.record].residual[i]);
    }
    if (!shown.x.empty()) panel.series.push_back(std::move(shown));
  }
  return panel;
}

/// Returns the samples per cycle, where the record determines it.
std::size_t SamplesOfCycle(const RecordFit& fit) {
  if (fit.reversals.size() < 2) return 0;
  return 2 * (fit.reversals.back() - fit.reversals.front()) / (fit.reversals.size() - 1);
}

double Quartile(std::vector<double>& values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + place);
  return values[static_cast<std::size_t>(place)];
}

}  // namespace

PanelUnits PlainUnits(const Report& report) {
  double extent = 0.0;
  for (const RecordFit& fit : report.fit.records) {
    extent = std::max(extent, std::abs(fit.measures.centre) + fit.measures.amplitude);
  }
  const ScaledUnit displacement = UnitFor(report.units.displacement, extent);
  const ScaledUnit force{.factor = 1.0, .name = std::string(report.units.force)};
  const bool is_of_force = report.fit.response == loop::Channel::kForce;
  return {
      .displacement = displacement, .force = force, .residual = is_of_force ? force : displacement};
}

PanelUnits PrefixedUnits(const Report& report) {
  PanelUnits units = PlainUnits(report);
  double force = 0.0;
  double residual = 0.0;
  for (const RecordFit& fit : report.fit.records) {
    force = std::max(force, std::abs(fit.measures.centre_force) + fit.measures.peak_force);
    for (const double value : fit.residual) residual = std::max(residual, std::abs(value));
  }
  units.force = UnitFor(report.units.force, force);
  units.residual = UnitFor(report.units.response, residual);
  return units;
}

PlotPanel LoopPanel(const Report& report, const PanelUnits& units, LoopColours colours) {
  const bool by_cycle = colours == LoopColours::kByCycle;
  PlotPanel panel{.x_label = by_cycle ? DisplacementLabel(report, units) : "",
                  .y_label = fmt::format("{} [{}]", ForceName(report), units.force.name),
                  .height = by_cycle ? 1.3 : 2.5};
  const double per_displacement = Per(units.displacement);
  const double per_force = Per(units.force);
  const std::string_view measured = "measured";
  for (const Group& group : GroupsOf(report, std::string(measured), colours)) {
    const loop::Record& record = report.records[group.record].record;
    panel.series.push_back(
        Range(group, record.displacement, per_displacement, record.force, per_force));
    if (by_cycle) continue;
    panel.series.push_back(FittedLine(report, group.record, units, record.size()));
    panel.series.back().label += group.label.substr(measured.size());
  }
  // A page spreads its points over all series: a line of more would lose the corners of its loops.
  constexpr std::size_t kPoints = 6000;
  const std::size_t most = kPoints / (panel.series.size() + report.records.size() + 1);
  for (std::size_t r = 0; r < report.records.size() && by_cycle; ++r) {
    panel.series.push_back(FittedLine(report, r, units, most));
    if (r > 0) panel.series.back().label.clear();
  }
  PlotSeries reversals{.label = "reversals", .style = PlotStyle::kMarkers};
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const loop::Record& record = report.records[r].record;
    for (const std::size_t sample : report.fit.records[r].reversals) {
      reversals.x.push_back(per_displacement * record.displacement[sample]);
      reversals.y.push_back(per_force * record.force[sample]);
    }
  }
  if (!reversals.x.empty()) panel.series.push_back(std::move(reversals));
  return panel;
}

PlotPanel ResidualAlongStroke(const Report& report, const PanelUnits& units, LoopColours colours) {
  return Residuals(report, units, DisplacementLabel(report, units), colours,
                   [&](std::size_t r, std::size_t i) -> std::optional<double> {
                     const loop::Record& record = report.records[r].record;
                     // Samples outside the load window would squeeze the rest together.
                     if (!IsUnderLoad(report, record, i)) return std::nullopt;
                     return Per(units.displacement) * record.displacement[i];
                   });
}

PlotPanel ResidualInTime(const Report& report, const PanelUnits& units) {
  const bool is_timed = std::ranges::none_of(
      report.records, [](const io::RecordFile& input) { return input.record.time.empty(); });
  return Residuals(report, units, is_timed ? "time [s]" : "sample", LoopColours::kByCycle,
                   [&](std::size_t r, std::size_t i) -> std::optional<double> {
                     if (!Counts(report.fit.records[r], i)) return std::nullopt;
                     return is_timed ? report.records[r].record.time[i]
                                     : static_cast<double>(i + 1);
                   });
}

PlotPanel ResidualDistribution(const Report& report, const PanelUnits& units) {
  std::vector<double> residuals = CountedResiduals(report);
  for (double& residual : residuals) residual *= Per(units.residual);
  const auto n = static_cast<double>(residuals.size());
  const double mean = std::accumulate(residuals.begin(), residuals.end(), 0.0) / n;
  double squares = 0.0;
  for (const double residual : residuals) squares += (residual - mean) * (residual - mean);
  const double deviation = std::sqrt(squares / std::max(n - 1, 1.0));
  PlotPanel panel{.x_label = ResidualLabel(units), .y_label = "samples"};
  if (!(deviation > 0)) {
    panel.series.push_back({"residuals", {mean}, {n}, PlotStyle::kBars});
    return panel;
  }
  constexpr double kFurthest = 5.0;  // standard deviations
  const auto [least, greatest] = std::ranges::minmax(residuals);
  const double from = std::max(least, mean - kFurthest * deviation);
  const double to = std::min(greatest, mean + kFurthest * deviation);
  std::vector<double> sorted = residuals;
  const double quartiles = Quartile(sorted, 0.75) - Quartile(sorted, 0.25);
  const double wanted = quartiles > 0 ? 2 * quartiles / std::cbrt(n) : (to - from) / 10;
  const auto bins = static_cast<std::size_t>(std::clamp((to - from) / wanted, 10.0, 60.0));
  const double width = (to - from) / static_cast<double>(bins);
  PlotSeries bars{.label = "residuals",
                  .y = std::vector<double>(bins, 0.0),
                  .style = PlotStyle::kBars,
                  .shade = kDataShade};
  std::size_t beyond = 0;
  for (const double residual : residuals) {
    if (residual < from || residual > to) {
      ++beyond;
      continue;
    }
    const auto bin = static_cast<std::size_t>((residual - from) / width);
    ++bars.y[std::min(bin, bins - 1)];
  }
  for (std::size_t k = 0; k < bins; ++k) {
    bars.x.push_back(from + (static_cast<double>(k) + 0.5) * width);
  }
  if (beyond > 0) bars.label += fmt::format(", {} more beyond the axis", beyond);
  PlotSeries curve{.label = "normal distribution of the same standard deviation"};
  constexpr int kSteps = 120;
  for (int i = 0; i <= kSteps; ++i) {
    const double at = from + (to - from) * i / kSteps;
    curve.x.push_back(at);
    const double z = (at - mean) / deviation;
    constexpr double kDensityAtMean = std::numbers::inv_sqrtpi / std::numbers::sqrt2;
    curve.y.push_back(n * width / deviation * kDensityAtMean * std::exp(-z * z / 2));
  }
  panel.series = {std::move(bars), std::move(curve)};
  return panel;
}

std::optional<PlotPanel> ResidualAutocorrelation(const Report& report) {
  constexpr std::size_t kLeastSamples = 8;
  constexpr std::size_t kLeastLags = 30;
  constexpr std::size_t kMostLags = 1500;
  constexpr double kMostProducts = 1e8;
  std::vector<std::vector<double>> records;
  std::size_t longest = 0;
  std::size_t cycle = 0;
  std::size_t samples = 0;
  double squares = 0.0;
  for (const RecordFit& fit : report.fit.records) {
    std::vector<double>& residuals = records.emplace_back(CountedResiduals(fit));
    longest = std::max(longest, residuals.size());
    cycle = std::max(cycle, SamplesOfCycle(fit));
    samples += residuals.size();
    for (const double residual : residuals) squares += residual * residual;
  }
  if (samples < kLeastSamples || !(squares > 0)) return std::nullopt;
  std::size_t lags = std::min({std::max(kLeastLags, cycle + cycle / 4), longest / 2, kMostLags});
  lags = std::min(lags, static_cast<std::size_t>(kMostProducts / static_cast<double>(samples)) + 1);
  PlotSeries correlation{.label = "residuals", .shade = kDataShade};
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    double products = 0.0;
    for (const std::vector<double>& residuals : records) {
      for (std::size_t i = lag; i < residuals.size(); ++i) {
        products += residuals[i] * residuals[i - lag];
      }
    }
    correlation.x.push_back(static_cast<double>(lag));
    correlation.y.push_back(products / squares);
  }
  const double limit = kNormalQuantile95 / std::sqrt(static_cast<double>(samples));
  const std::vector<double> ends = {0.0, static_cast<double>(lags)};
  PlotSeries white{.label = "white noise, 95 %",
                   .x = ends,
                   .y = {0.0, 0.0},
                   .style = PlotStyle::kBand,
                   .lower = {-limit, -limit},
                   .upper = {limit, limit}};
  return PlotPanel{.x_label = "samples apart",
                   .y_label = "autocorrelation of the residuals",
                   .series = {std::move(correlation), std::move(white)}};
}

std::optional<PlotPanel> SlipForceLikelihood(const Report& report) {
  const auto& profile = report.fit.slip_force_profile;
  if (!profile || profile->points.size() < 2 ||
      report.fit.adequacy.verdict == AdequacyVerdict::kInadequate) {
    return std::nullopt;
  }
  constexpr double kHighest = 4.0;  // of what is drawn, over the critical value
  const double ceiling = kHighest * profile->critical;
  std::vector<identification::ProfilePoint> shown;
  for (std::size_t k = 0; k < profile->points.size(); ++k) {
    const auto& points = profile->points;
    const bool is_near = points[k].statistic <= ceiling ||
                         (k > 0 && points[k - 1].statistic <= ceiling) ||
                         (k + 1 < points.size() && points[k + 1].statistic <= ceiling);
    if (is_near) shown.push_back(points[k]);
  }
  const ScaledUnit unit = UnitFor(report.units.force, report.fit.law.slip_force);
  PlotSeries curve{.label = "refitted with Tc fixed at each point",
                   .style = PlotStyle::kLineAndPoints,
                   .shade = kDataShade};
  for (const identification::ProfilePoint& point : shown) {
    curve.x.push_back(point.law.slip_force / unit.factor);
    curve.y.push_back(std::min(point.statistic, ceiling));
  }
  PlotSeries critical{"critical value: outside the interval above it",
                      {curve.x.front(), curve.x.back()},
                      {profile->critical, profile->critical},
                      PlotStyle::kLine};
  return PlotPanel{.x_label = fmt::format("slip force Tc, fixed [{}]", unit.name),
                   .y_label = "F against the best fit",
                   .series = {std::move(curve), std::move(critical)},
                   .log_x = true};
}

std::optional<PlotPanel> RegionPanel(const Report& report, std::string_view first) {
  const auto& regions = report.fit.regions;
  if (!regions) return std::nullopt;
  const auto region = std::ranges::find_if(
      *regions, [&](const auto& candidate) { return candidate.parameters[0] == first; });
  const identification::ParameterEstimate* estimate = report.fit.Find(first);
  if (region == regions->end() || WhatIsShown(*estimate) != Shown::kValue ||
      WhatIsShown(*report.fit.Find("alpha")) != Shown::kValue) {
    return std::nullopt;
  }
  const ScaledUnit unit = UnitFor(estimate->unit, estimate->value);
  PlotSeries boundary{.label = fmt::format("{} region{}", ConfidenceWords(report.fit),
                                           region->closed ? "" : ", open where it ends"),
                      .shade = kDataShade};
  for (std::size_t i = 0; i <= region->boundary.size(); ++i) {
    const auto& [x, y] = region->boundary[i % region->boundary.size()];
    boundary.x.push_back(x / unit.factor);
    boundary.y.push_back(y);
  }
  const auto [low, high] = std::ranges::minmax(boundary.x);
  PlotSeries best{"estimate",
                  {estimate->value / unit.factor},
                  {report.fit.law.shape_exponent},
                  PlotStyle::kMarkers};
  PlotSeries mindlin{"Mindlin's α = 1/3", {low, high}, {1.0 / 3, 1.0 / 3}, PlotStyle::kLine};
  return PlotPanel{.x_label = fmt::format(
                       "{} [{}]", first == "sigma" ? "stiffness σ" : "slip force Tc", unit.name),
                   .y_label = "shape exponent α",
                   .series = {std::move(boundary), std::move(best), std::move(mindlin)}};
}

std::optional<PlotPanel> LoadPanel(const Report& report, const PanelUnits& units,
                                   OverLoad quantity) {
  if (!report.load_series) return std::nullopt;
  const bool is_stiffness = quantity == OverLoad::kStiffness;
  const double scale = is_stiffness ? 1 / Per(units.displacement) : 1.0;
  const identification::FitResult& fit = report.fit;
  PlotPanel panel{.x_label = "normal load N [N]",
                  .y_label = is_stiffness ? fmt::format("σ [{}/{}]", report.units.force,
                                                        units.displacement.name)
                                          : fmt::format("Tc [{}]", report.units.force),
                  .height = 1.2};
  double least = report.load_series->contacts.front().normal_load;
  double greatest = least;
  PlotSeries alone{.label = "each file alone, " + ConfidenceWords(report.fit),
                   .style = PlotStyle::kIntervals};
  for (const ContactUnderLoad& contact : report.load_series->contacts) {
    least = std::min(least, contact.normal_load);
    greatest = std::max(greatest, contact.normal_load);
    if (!contact.alone) continue;
    const ParameterEstimate& estimate =
        is_stiffness ? contact.alone->stiffness : contact.alone->slip_force;
    // A loop far from slip leaves Tc open, up to more than a double holds.
    if (!estimate.is_known() || !estimate.lower95 || !estimate.upper95) continue;
    if (!std::isfinite(*estimate.lower95) || !std::isfinite(*estimate.upper95)) continue;
    alone.x.push_back(contact.normal_load);
    alone.y.push_back(scale * estimate.value);
    alone.lower.push_back(scale * *estimate.lower95);
    alone.upper.push_back(scale * *estimate.upper95);
  }
  const auto is_known = [&fit](std::string_view name) {
    const ParameterEstimate* const estimate = fit.Find(name);
    return estimate != nullptr && estimate->is_known();
  };
  const bool has_line =
      is_stiffness ? is_known("sigma") && is_known("load_exponent") : is_known("slip_force");
  if (has_line) {
    constexpr int kSteps = 60;
    PlotSeries line{.label = is_stiffness
                                 ? fmt::format("σ ∝ N^{:.3g}, the series", fit.load_exponent)
                                 : std::string("Tc = μN, the series")};
    for (int i = 0; i <= kSteps; ++i) {
      const double load = least + (greatest - least) * i / kSteps;
      const double ratio = load / *fit.normal_load;
      line.x.push_back(load);
      const models::BranchLaw law = models::AtLoad(fit.law, ratio, fit.load_exponent);
      line.y.push_back(scale * (is_stiffness ? law.tangential_stiffness : law.slip_force));
    }
    panel.series.push_back(std::move(line));
  }
  if (!alone.x.empty()) panel.series.push_back(std::move(alone));
  if (panel.series.empty()) return std::nullopt;
  return panel;
}

using identification::FitResult;
using identification::Identifiability;
using identification::ParameterStatus;

namespace {

/// Returns a parameter by its sign: no number of what is not known.
std::string ParameterText(const char* sign, const ParameterEstimate& estimate) {
  if (estimate.status == ParameterStatus::kFixed) {
    return fmt::format("{} = {}, fixed", sign, Quantity(estimate.value, estimate.unit));
  }
  if (estimate.is_known()) {
    return fmt::format("{} = {}", sign,
                       QuantityWithError(estimate.value, estimate.standard_error, estimate.unit));
  }
  if (estimate.identifiability == Identifiability::kBoundedBelow && estimate.lower95) {
    return fmt::format("{} > {}", sign, Quantity(*estimate.lower95, estimate.unit, 3));
  }
  return fmt::format("{} not known", sign);
}

std::string FindingsOf(const Report& report) {
  const FitResult& fit = report.fit;
  return fmt::format("{}: {}, {}, {}", fit.model->name, ParameterText("σ", *fit.Find("sigma")),
                     ParameterText("α", *fit.Find("alpha")),
                     ParameterText("Tc", *fit.Find("slip_force")));
}

}  // namespace

io::Plot ToPlot(const Report& report) {
  RequireFitted(report, "a figure");
  io::Plot plot;
  plot.title = TitleOf(report);
  plot.subtitle = FindingsOf(report);
  const PanelUnits units = PlainUnits(report);
  plot.panels = {LoopPanel(report, units, LoopColours::kOneARecord),
                 ResidualAlongStroke(report, units, LoopColours::kOneARecord)};
  std::optional<io::PlotPanel> stiffness = LoadPanel(report, units, OverLoad::kStiffness);
  std::optional<io::PlotPanel> slip_force = LoadPanel(report, units, OverLoad::kSlipForce);
  if (stiffness && slip_force) stiffness->x_label.clear();
  for (std::optional<io::PlotPanel>* const panel : {&stiffness, &slip_force}) {
    constexpr int kTaller = 200;  // [px] a panel
    if (!*panel) continue;
    plot.height += kTaller;
    plot.panels.push_back(std::move(**panel));
  }
  return plot;
}

}  // namespace mindahl::report
