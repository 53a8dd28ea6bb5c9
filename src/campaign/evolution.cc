#include "mindahl/campaign/evolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <utility>

#include "mindahl/report/units.h"
#include "report/statements.h"

namespace mindahl::campaign {

namespace {

constexpr std::array kQuantities = {
    TrackedQuantity{"friction_coefficient", "μ", "", "slip_force_error"},
    TrackedQuantity{"slip_force", "Tc", "slip_force_open", "slip_force_error"},
    TrackedQuantity{"half_gap", "half gap", "", "rms"},
    TrackedQuantity{"sigma", "σ", "sigma_open", "sigma_error"},
    TrackedQuantity{"contact_radius", "a", "sigma_open", "sigma_error"},
    TrackedQuantity{"alpha", "", "alpha_open", "alpha_error"},
    TrackedQuantity{"energy", "", "", "rms", /*is_drawn=*/false},
    TrackedQuantity{"energy_ratio", "", "", "rms"},
};

/// Returns one over the square of an error, within what sums of a million million neither overflow
/// nor lose.
double WeightOf(double error) {
  constexpr double kLargest = 1e290;
  return std::clamp(1 / error / error, 1 / kLargest, kLargest);
}

/// Returns "+60 %"; nothing where the sign changes or it grows more than tenfold.
std::string RelativeChange(double from, double to) {
  constexpr double kMost = 10;
  const double change = to / from - 1;
  if (!(change > -1 && change < kMost)) return "";
  return fmt::format("{:+.{}f} %", 100 * change, std::abs(change) < 0.1 ? 1 : 0);
}

/// Returns "0.352 → 0.600" or "250 → 400 µm".
std::string FromTo(double from, double to, const std::string& unit) {
  const double largest = std::max(std::abs(from), std::abs(to));
  const report::ScaledUnit scaled = report::UnitFor(unit, largest);
  constexpr int kMost = 9;
  const int decimals =
      largest > 0
          ? std::clamp(2 - static_cast<int>(std::floor(std::log10(largest / scaled.factor))), 0,
                       kMost)
          : 0;
  return fmt::format("{:.{}f} → {:.{}f}{}{}", from / scaled.factor, decimals, to / scaled.factor,
                     decimals, scaled.name.empty() ? "" : " ", scaled.name);
}

io::PlotPanel EvolutionPanel(const Evolution& evolution) {
  constexpr double kShade = 0.3;  // of what is measured
  constexpr double kManyCycles = 100;
  const std::span<const Course::Bin> bins = evolution.course.bins();
  io::PlotPanel panel{.log_x = bins.back().cycle >= kManyCycles * bins.front().cycle};
  io::PlotSeries course{.label = "", .style = io::PlotStyle::kBand, .shade = kShade};
  for (const Course::Bin& bin : bins) {
    course.x.push_back(bin.cycle);
    course.y.push_back(bin.value);
    course.lower.push_back(bin.least);
    course.upper.push_back(bin.greatest);
  }
  panel.series.push_back(std::move(course));
  report::ScaleAxes(panel, "cycle", "-", evolution.quantity->name, evolution.unit);
  for (const Change& step : evolution.description.steps) {
    panel.marks.push_back({.x = static_cast<double>(step.first_cycle),
                           .label = fmt::format("step, {}", step.first_cycle)});
  }
  if (const std::optional<std::size_t> settled = evolution.description.settled_at) {
    panel.marks.push_back(
        {.x = static_cast<double>(*settled), .label = fmt::format("settled, {}", *settled)});
  }
  return panel;
}

}  // namespace

std::span<const TrackedQuantity> TrackedQuantities() { return kQuantities; }

TrackedCourses::TrackedCourses() : courses_(kQuantities.size()) {}

void TrackedCourses::Add(const CycleFit& fit) {
  for (std::size_t k = 0; k < kQuantities.size(); ++k) {
    const TrackedQuantity& quantity = kQuantities[k];
    const std::optional<double>& value = fit[quantity.name];
    if (!value || fit.HasFlag("not_converged") || fit.HasFlag(quantity.open_flag)) continue;
    // A value without an error is exact, held or without noise: then all have one weight.
    const std::optional<double>& error = fit[quantity.error];
    courses_[k].Add(fit.number, *value, error && *error > 0 ? WeightOf(*error) : 1.0);
  }
}

std::vector<Evolution> TrackedCourses::Describe(bool is_torsional) const {
  const report::Units& units = report::UnitsOf(is_torsional);
  std::vector<Evolution> evolutions;
  for (std::size_t k = 0; k < kQuantities.size(); ++k) {
    if (const std::optional<CourseDescription> found = campaign::Describe(courses_[k])) {
      const std::string_view unit = kCycleNumbers.at(PlaceOf(kQuantities[k].name)).unit;
      evolutions.push_back({&kQuantities[k],
                            std::string(report::UnitIn(units, unit.empty() ? "-" : unit)),
                            courses_[k], *found});
    }
  }
  return evolutions;
}

void DissipatedEnergy::Add(const CycleFit& fit) {
  constexpr std::size_t kNeighbours = 9;
  const double steps = fit.samples > 1 ? static_cast<double>(fit.samples - 1) : 0.0;
  const bool is_open = fit.HasFlag("not_closed");
  if (is_open && !of_a_step.empty()) {
    std::vector<double> neighbours(of_a_step.begin(), of_a_step.end());
    total += static_cast<double>(cycles) * steps * boost::math::statistics::median(neighbours);
    ++replaced;
  } else if (is_open || !fit["energy"]) {
    ++left_out;
  } else {
    total += static_cast<double>(cycles) * *fit["energy"];
    ++measured;
    if (of_a_step.size() == kNeighbours) of_a_step.pop_front();
    of_a_step.push_back(*fit["energy"] / steps);
  }
}

std::string Headline(std::span<const Evolution> evolutions) {
  std::string text;
  bool has_force = false;
  for (const Evolution& evolution : evolutions) {
    const TrackedQuantity& quantity = *evolution.quantity;
    const CourseDescription& course = evolution.description;
    if (quantity.symbol.empty()) continue;
    const bool is_force = quantity.name == "friction_coefficient" ||
                          quantity.name == "slip_force" || quantity.name == "half_gap";
    if (is_force && std::exchange(has_force, true)) continue;
    const std::string change = RelativeChange(course.first, course.last);
    const bool in_percent = quantity.name == "sigma" && !change.empty();
    text += fmt::format("{}{} ", text.empty() ? "" : "; ", quantity.symbol);
    constexpr std::size_t kFewRows = 20;  // no test of a change has power over so few
    const std::string first = report::Quantity(course.first, evolution.unit, 3);
    if (!course.changed() && evolution.course.bins().size() < kFewRows) {
      const bool is_one = first == report::Quantity(course.last, evolution.unit, 3);
      text += is_one ? first : FromTo(course.first, course.last, evolution.unit);
      text += ", in too few rows to test";
    } else if (!course.changed()) {
      // The first and the last cycle differ by scatter only, so one value stands for both.
      text += first + " throughout, but for scatter";
    } else {
      text += in_percent ? change : FromTo(course.first, course.last, evolution.unit);
    }
    if (course.settled_at) text += fmt::format(", settled at cycle {}", *course.settled_at);
  }
  return text;
}

std::vector<std::string> ChangeStatements(std::span<const Evolution> evolutions, std::size_t most) {
  struct Statement {
    double size;  // relative
    std::string text;
  };
  std::vector<Statement> statements;
  const auto add = [&](const Evolution& evolution, const std::string& when, double from, double to,
                       double p_value) {
    const std::string change = RelativeChange(from, to);
    statements.push_back(
        {std::abs(to - from) / std::max(std::abs(from), std::abs(to)),
         fmt::format("{}: {}, {}{}, {}", evolution.quantity->name, when,
                     FromTo(from, to, evolution.unit), change.empty() ? "" : " (" + change + ")",
                     report::ChanceText(p_value, 1))});
  };
  for (const Evolution& evolution : evolutions) {
    for (const Change& trend : evolution.description.trends) {
      add(evolution, fmt::format("cycles {} to {}", trend.first_cycle, trend.last_cycle),
          trend.from, trend.to, trend.p_value);
    }
    for (const Change& step : evolution.description.steps) {
      add(evolution, fmt::format("a step at cycle {}", step.first_cycle), step.from, step.to,
          step.p_value);
    }
  }
  std::vector<const Statement*> said;
  said.reserve(statements.size());
  for (const Statement& statement : statements) said.push_back(&statement);
  if (said.size() > most) {  // one line says how many more
    std::ranges::stable_sort(said, std::greater<>(), &Statement::size);
    said.resize(most - 1);
    std::ranges::sort(said);
  }
  std::vector<std::string> lines;
  lines.reserve(said.size() + 1);
  for (const Statement* statement : said) lines.push_back(statement->text);
  if (said.size() < statements.size()) {
    lines.push_back(
        fmt::format("and {} smaller ones, which --json lists", statements.size() - said.size()));
  }
  return lines;
}

std::vector<io::PlotPanel> EvolutionPanels(std::span<const Evolution> evolutions) {
  const bool has_friction = std::ranges::any_of(evolutions, [](const Evolution& evolution) {
    return evolution.quantity->name == "friction_coefficient";
  });
  std::vector<io::PlotPanel> panels;
  for (const Evolution& evolution : evolutions) {
    if (!evolution.quantity->is_drawn || evolution.course.bins().size() < 2) continue;
    if (has_friction && evolution.quantity->name == "slip_force") continue;
    panels.push_back(EvolutionPanel(evolution));
  }
  return panels;
}

io::PlotPanel FrettingLog(std::span<const Cycle> cycles, bool is_torsional) {
  io::PlotPanel panel;
  for (const Cycle& cycle : cycles) {
    io::PlotSeries loop{.label = fmt::format("cycle {}", cycle.number),
                        .x = cycle.record.displacement,
                        .y = cycle.record.force};
    loop.shade = cycles.size() < 2 ? 0.0
                                   : static_cast<double>(panel.series.size()) /
                                         static_cast<double>(cycles.size() - 1);
    panel.series.push_back(std::move(loop));
  }
  const report::Units& units = report::UnitsOf(is_torsional);
  report::ScaleAxes(panel, is_torsional ? "angle" : "displacement", units.displacement,
                    is_torsional ? "torque" : "force", units.force);
  return panel;
}

}  // namespace mindahl::campaign
