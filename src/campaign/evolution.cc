#include "mindahl/campaign/evolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/probability.h"
#include "mindahl/core/error.h"
#include "mindahl/report/quantity.h"

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
  io::PlotPanel panel{
      .x_label = "cycle", .y_label = report::WithUnit(evolution.name, unit.name), .series = {}};
  io::PlotSeries course{evolution.has_errors ? "cycles, 95 % of one" : "cycles, least and greatest",
                        {},
                        {},
                        io::PlotStyle::kBand};
  course.shade = kShade;
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
    io::PlotSeries line{k == 0 ? "stretches" : "", {}, {}, io::PlotStyle::kLine};
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
    throw InvalidArgument("there is no time history to draw: no quantity is known of two cycles");
  }
  for (std::size_t k = 0; k + 1 < plot.panels.size(); ++k) plot.panels[k].x_label.clear();
  plot.height = kPanelHeight * static_cast<int>(plot.panels.size() + 1);
  return plot;
}

}  // namespace mindahl::campaign
