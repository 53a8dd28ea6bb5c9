#include "mindahl/campaign/evolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/probability.h"
#include "mindahl/core/error.h"
#include "mindahl/report/units.h"

namespace mindahl::campaign {

namespace {

constexpr double kShade = 0.3;  // of what is measured

std::string_view Words(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kEndOfRunningIn:
      return "running-in ends";
    case ChangeKind::kTransition:
      return "step";
    case ChangeKind::kBend:
      return "other rate";
  }
  return "change";
}

io::PlotPanel EvolutionPanel(const Evolution& evolution) {
  const std::span<const Course::Bin> bins = evolution.course.bins();
  double largest = 0.0;
  for (const Course::Bin& bin : bins) largest = std::max(largest, std::abs(bin.value));
  const report::ScaledUnit unit = report::UnitFor(evolution.unit, largest);
  io::PlotPanel panel{.x_label = "cycle", .y_label = report::WithUnit(evolution.name, unit.name)};
  io::PlotSeries course{
      .label = evolution.has_errors ? "cycles, 95 % of one" : "cycles, least and greatest",
      .style = io::PlotStyle::kBand,
      .shade = kShade};
  for (const Course::Bin& bin : bins) {
    const double error =
        kNormalQuantile95 * std::sqrt(static_cast<double>(bin.count) / bin.weight) / unit.factor;
    const double value = bin.value / unit.factor;
    course.x.push_back(bin.cycle);
    course.y.push_back(value);
    course.lower.push_back(evolution.has_errors ? value - error : bin.least / unit.factor);
    course.upper.push_back(evolution.has_errors ? value + error : bin.greatest / unit.factor);
  }
  panel.series.push_back(std::move(course));
  for (std::size_t k = 0; k < evolution.description.stretches.size(); ++k) {
    const Stretch& stretch = evolution.description.stretches[k];
    io::PlotSeries line{.label = k == 0 ? "stretches" : ""};
    constexpr int kStepsOfCurve = 40;
    const int steps = stretch.time_constant ? kStepsOfCurve : 1;
    const auto first = static_cast<double>(stretch.first_cycle);
    const double way = static_cast<double>(stretch.last_cycle) - first;
    for (int step = 0; step <= steps; ++step) {
      line.x.push_back(first + way * step / steps);
      line.y.push_back(stretch.At(line.x.back()) / unit.factor);
    }
    panel.series.push_back(std::move(line));
  }
  for (const Change& change : evolution.description.changes) {
    panel.marks.push_back({.x = static_cast<double>(change.cycle),
                           .label = fmt::format("{}, {}", Words(change.kind), change.cycle)});
  }
  return panel;
}

}  // namespace

std::vector<io::PlotPanel> EvolutionPanels(std::span<const Evolution> evolutions) {
  std::vector<io::PlotPanel> panels;
  for (const Evolution& evolution : evolutions) {
    if (evolution.course.bins().size() > 1) panels.push_back(EvolutionPanel(evolution));
  }
  return panels;
}

io::Plot EvolutionPlot(std::span<const Evolution> evolutions, const std::string& title,
                       const std::string& subtitle) {
  constexpr int kPanelHeight = 230;  // [px]
  io::Plot plot;
  plot.title = title;
  plot.subtitle = subtitle;
  plot.panels = EvolutionPanels(evolutions);
  if (plot.panels.empty()) {
    throw InvalidArgument("there is no time history to draw: no quantity is known for two cycles");
  }
  for (std::size_t k = 0; k + 1 < plot.panels.size(); ++k) plot.panels[k].x_label.clear();
  plot.height = kPanelHeight * static_cast<int>(plot.panels.size() + 1);
  return plot;
}

namespace {

std::optional<double> Rms(const CycleFit& fit) { return fit.rms; }

constexpr std::array kQuantities = {
    TrackedQuantity{"sigma", "N/m", "sigma_open",
                    [](const CycleFit& fit) { return fit.sigma.value; },
                    [](const CycleFit& fit) { return fit.sigma.standard_error; },
                    /*is_drawn=*/true, /*has_standard_error=*/true},
    TrackedQuantity{"alpha", "-", "alpha_open", [](const CycleFit& fit) { return fit.alpha.value; },
                    [](const CycleFit& fit) { return fit.alpha.standard_error; },
                    /*is_drawn=*/true, /*has_standard_error=*/true},
    TrackedQuantity{"slip_force", "N", "slip_force_open",
                    [](const CycleFit& fit) { return fit.slip_force.value; },
                    [](const CycleFit& fit) { return fit.slip_force.standard_error; },
                    /*is_drawn=*/true, /*has_standard_error=*/true},
    TrackedQuantity{"friction_coefficient", "-", "",
                    [](const CycleFit& fit) { return fit.friction_coefficient; },
                    [](const CycleFit& fit) { return fit.slip_force.standard_error; },
                    /*is_drawn=*/true},
    TrackedQuantity{"half_gap", "N", "", [](const CycleFit& fit) { return fit.half_gap; }, Rms,
                    /*is_drawn=*/true},
    TrackedQuantity{"energy", "J", "", [](const CycleFit& fit) { return fit.energy; }, Rms},
    TrackedQuantity{"energy_ratio", "-", "", [](const CycleFit& fit) { return fit.energy_ratio; },
                    Rms, /*is_drawn=*/true},
};

/// Returns one over the square of an error, within what sums of a million million neither overflow
/// nor lose.
double WeightOf(double error) {
  constexpr double kLargest = 1e290;
  return std::clamp(1 / error / error, 1 / kLargest, kLargest);
}

/// Returns "p 0.003", or that p is too small to state.
std::string ChanceText(double p_value) {
  return p_value < 1e-12 ? "p < 1e-12" : fmt::format("p {:.1g}", p_value);
}

std::string TextOf(const Change& change) {
  const std::string_view what = change.kind == ChangeKind::kTransition ? "a step" : "a new rate";
  return fmt::format("at cycle {} ({} to {}) {}, {:.5g} to {:.5g}, {}", change.cycle,
                     change.lower95, change.upper95, what, change.before, change.after,
                     ChanceText(change.p_value));
}

std::string TextOf(const Stretch& stretch) {
  return fmt::format("from cycle {} to {} a trend, {:.5g} to {:.5g}, {}", stretch.first_cycle,
                     stretch.last_cycle, stretch.at_start, stretch.at_end,
                     ChanceText(stretch.slope_p_value));
}

}  // namespace

std::span<const TrackedQuantity> TrackedQuantities() { return kQuantities; }

TrackedCourses::TrackedCourses() : courses_(kQuantities.size()), have_errors_(kQuantities.size()) {}

void TrackedCourses::Add(const CycleFit& fit) {
  for (std::size_t k = 0; k < kQuantities.size(); ++k) {
    const TrackedQuantity& quantity = kQuantities[k];
    const std::optional<double> value = quantity.of(fit);
    if (!value || fit.HasFlag("not_converged") || fit.HasFlag(quantity.open_flag)) continue;
    // A value without an error is exact, held or without noise: then all have one weight.
    const std::optional<double> error = quantity.error(fit);
    const bool has_error = error && *error > 0;
    courses_[k].Add(fit.number, *value, has_error ? WeightOf(*error) : 1.0);
    if (has_error) have_errors_[k] = true;
  }
}

std::vector<CourseDescription> TrackedCourses::Describe() const {
  std::vector<CourseDescription> descriptions;
  descriptions.reserve(courses_.size());
  for (const Course& course : courses_) descriptions.push_back(FindChanges(course));
  return descriptions;
}

std::vector<std::string> SmallTrendStatements(const CourseDescription& course,
                                              const ChangeThresholds& thresholds) {
  std::vector<std::string> lines;
  for (const Stretch& stretch : course.stretches) {
    if (stretch.trends || !(stretch.slope_p_value < thresholds.chance)) continue;
    lines.push_back(TextOf(stretch));
  }
  return lines;
}

std::vector<std::string> ChangeStatements(const CourseDescription& course) {
  std::vector<std::string> lines;
  const auto settled =
      std::ranges::find(course.changes, ChangeKind::kEndOfRunningIn, &Change::kind);
  std::size_t first = 0;  // first segment not yet described
  if (settled != course.changes.end()) {
    lines.push_back(fmt::format("running-in up to cycle {} ({} to {}), {:.5g} to {:.5g}, {}",
                                settled->cycle, settled->lower95, settled->upper95,
                                course.stretches.front().at_start, settled->before,
                                ChanceText(settled->p_value)));
    first = static_cast<std::size_t>(settled - course.changes.begin()) + 1;
  }
  for (std::size_t k = first; k < course.stretches.size(); ++k) {
    if (k > first) lines.push_back(TextOf(course.changes[k - 1]));
    if (course.stretches[k].trends) lines.push_back(TextOf(course.stretches[k]));
  }
  return lines;
}

}  // namespace mindahl::campaign
