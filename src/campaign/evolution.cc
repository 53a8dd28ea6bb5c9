#include "mindahl/campaign/evolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/probability.h"
#include "mindahl/report/units.h"
#include "report/statements.h"

namespace mindahl::campaign {

namespace {

constexpr double kChance = 0.01;         // of a change, or of a trend, where there is none
constexpr double kSmallestStep = 0.02;   // [-] of the value before it
constexpr double kSmallestTrend = 0.01;  // [-] of the segment's mean
constexpr double kSettled = 0.05;        // [-] of the whole change
constexpr std::size_t kLeastBins = 4;    // of a segment: two beyond a line
constexpr int kDepth = 3;                // up to eight segments

using Bins = std::span<const Course::Bin>;

/// A weighted least-squares line through bins: y = level + slope (x − x₀).
struct Line {
  double x0 = 0.0;
  double level = 0.0;
  double slope = 0.0;
  double spread = 0.0;   // Σw(x − x₀)², the mean weight 1
  double squares = 0.0;  // Σw(y − line)²

  [[nodiscard]] double At(double x) const { return level + slope * (x - x0); }
};

Line LineThrough(Bins bins) {
  double weights = 0.0;
  Line line;
  for (const Course::Bin& bin : bins) weights += bin.weight;
  const double mean_weight = weights / static_cast<double>(bins.size());
  for (const Course::Bin& bin : bins) {
    line.x0 += bin.weight / weights * bin.cycle;
    line.level += bin.weight / weights * bin.value;
  }
  double product = 0.0;
  for (const Course::Bin& bin : bins) {
    const double w = bin.weight / mean_weight;
    line.spread += w * (bin.cycle - line.x0) * (bin.cycle - line.x0);
    product += w * (bin.cycle - line.x0) * (bin.value - line.level);
  }
  line.slope = line.spread > 0 ? product / line.spread : 0.0;
  for (const Course::Bin& bin : bins) {
    const double left = bin.value - line.At(bin.cycle);
    line.squares += bin.weight / mean_weight * left * left;
  }
  return line;
}

/// Returns the squares that rounding leaves of values of this size.
double Rounding(Bins bins) {
  double largest = 0.0;
  for (const Course::Bin& bin : bins) largest = std::max(largest, std::abs(bin.value));
  constexpr double kDigits = 1e-12;
  return static_cast<double>(bins.size()) * (kDigits * largest) * (kDigits * largest);
}

/// Returns how many independent values the residuals of a line are worth, by their lag-one
/// correlation.
double EffectiveCount(Bins bins, const Line& line) {
  double product = 0.0;
  double squares = 0.0;
  double last = 0.0;
  for (const Course::Bin& bin : bins) {
    const double left = bin.value - line.At(bin.cycle);
    product += left * last;
    squares += left * left;
    last = left;
  }
  const auto count = static_cast<double>(bins.size());
  const double correlation =
      squares > Rounding(bins) ? std::clamp(product / squares, 0.0, 0.99) : 0.0;
  return count * (1 - correlation) / (1 + correlation);
}

/// Bins that are left out between two segments: a change falls within a bin of several cycles.
std::size_t GapOf(Bins bins) { return bins.front().count > 1 ? 1 : 0; }

/// Appends the ends of segments with the probability of each; the last is that of all bins.
void Divide(Bins bins, std::size_t offset, int depth,
            std::vector<std::pair<std::size_t, double>>& ends) {
  const auto none = [&] { ends.emplace_back(offset + bins.size(), 1.0); };
  if (depth == 0 || bins.size() < 4 * kLeastBins) return none();
  std::size_t place = 0;
  double least = std::numeric_limits<double>::infinity();
  const std::size_t gap = GapOf(bins);
  for (std::size_t k = kLeastBins; k + gap + kLeastBins <= bins.size(); ++k) {
    const double squares =
        LineThrough(bins.first(k)).squares + LineThrough(bins.subspan(k + gap)).squares;
    if (squares < least) {
      least = squares;
      place = k;
    }
  }
  const Bins left = bins.first(place);
  const Bins right = bins.subspan(place + gap);
  const double one = LineThrough(bins).squares;
  least = std::max(least, Rounding(bins));
  // Squares of numbers near the largest double overflow.
  if (place == 0 || !(one > 2 * Rounding(bins)) || !std::isfinite(one)) return none();
  const double independent =
      EffectiveCount(left, LineThrough(left)) + EffectiveCount(right, LineThrough(right));
  constexpr double kMore = 3;  // a level, a slope and a place
  const double degrees = independent - 5;
  if (degrees < 1) return none();
  const double f = std::max(0.0, one - least) / kMore / (least / degrees);
  const double p_value =
      std::min(1.0, static_cast<double>(bins.size()) * PValueOfF(f, kMore, degrees));
  if (!(p_value < kChance)) return none();
  Divide(left, offset, depth - 1, ends);
  ends.back().second = p_value;
  Divide(right, offset + place + gap, depth - 1, ends);
}

/// Returns a line's value within what values there were.
double Stated(const Line& line, double cycle, Bins bins) {
  const auto least = std::ranges::min_element(bins, {}, &Course::Bin::least)->least;
  const auto greatest = std::ranges::max_element(bins, {}, &Course::Bin::greatest)->greatest;
  return std::clamp(line.At(cycle), least, greatest);
}

std::optional<Change> TrendOf(Bins bins, const Line& line) {
  const double degrees = std::max(1.0, EffectiveCount(bins, line) - 2);
  const double squares = std::max(line.squares, Rounding(bins));
  if (bins.size() <= 2 || !(squares > 0 && std::isfinite(squares))) return std::nullopt;
  const double p_value =
      PValueOfT(line.slope / std::sqrt(squares / degrees / line.spread), degrees);
  const Change trend{bins.front().first_cycle, bins.back().last_cycle,
                     Stated(line, bins.front().cycle, bins), Stated(line, bins.back().cycle, bins),
                     p_value};
  const bool is_large = std::abs(trend.to - trend.from) >= kSmallestTrend * std::abs(line.level);
  return p_value < kChance && is_large ? std::optional(trend) : std::nullopt;
}

/// Returns the standard deviation of normal noise whose differences have this median.
double Scatter(Bins bins) {
  std::vector<double> differences = {0.0};
  for (std::size_t i = 1; i < bins.size(); ++i) {
    differences.push_back(std::abs(bins[i].value - bins[i - 1].value));
  }
  return 1.4826 / std::numbers::sqrt2 * boost::math::statistics::median(differences);
}

/// Returns the bins, of which none is alone far from both of its neighbours.
std::vector<Course::Bin> WithoutOutliers(Bins bins) {
  constexpr double kFar = 6;  // standard deviations
  const double far = kFar * Scatter(bins);
  std::vector<Course::Bin> kept(bins.begin(), bins.end());
  for (std::size_t i = 1; i + 1 < bins.size(); ++i) {
    const auto [low, high] = std::minmax(bins[i - 1].value, bins[i + 1].value);
    const double middle = std::clamp(bins[i].value, low, high);
    if (std::abs(bins[i].value - middle) > far) kept[i].value = middle;
  }
  return kept;
}

std::optional<std::size_t> SettledAt(Bins bins) {
  if (bins.size() < 4 * kLeastBins) return std::nullopt;
  const std::size_t tail = std::max<std::size_t>(1, bins.size() / 10);
  std::vector<double> ends;
  for (const Course::Bin& bin : bins.last(tail)) ends.push_back(bin.value);
  const double level = boost::math::statistics::median(ends);
  const double change = std::abs(level - bins.front().value);
  const double band = std::max(kSettled * change, 3 * Scatter(bins));
  if (!(change > 2 * band)) return std::nullopt;
  std::size_t settled = bins.size();
  while (settled > 0 && std::abs(bins[settled - 1].value - level) <= band) --settled;
  if (settled + tail >= bins.size()) return std::nullopt;
  // Nor does it go on beyond the scatter.
  const Bins rest = bins.subspan(settled);
  const double drift = LineThrough(rest).slope * (rest.back().cycle - rest.front().cycle);
  if (std::abs(drift) > 2 * kSettled * change) return std::nullopt;
  return bins[settled].first_cycle;
}

}  // namespace

std::optional<CourseDescription> Describe(const Course& course) {
  if (course.bins().empty()) return std::nullopt;
  const std::vector<Course::Bin> kept = WithoutOutliers(course.bins());
  const Bins bins = kept;
  CourseDescription description{
      .first = course.first(), .last = course.last(), .settled_at = SettledAt(bins)};
  std::vector<std::pair<std::size_t, double>> ends;
  Divide(bins, 0, kDepth, ends);
  std::size_t begin = 0;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const auto [end, p_value] = ends[k];
    const Bins segment = bins.subspan(begin, end - begin);
    const Line line = LineThrough(segment);
    if (const std::optional<Change> trend = TrendOf(segment, line)) {
      description.trends.push_back(*trend);
    }
    if (k + 1 < ends.size()) {
      const std::size_t start = end + GapOf(bins);
      const Bins next = bins.subspan(start, ends[k + 1].first - start);
      const double before = Stated(line, segment.back().cycle, segment);
      const double after = Stated(LineThrough(next), next.front().cycle, next);
      if (std::abs(after - before) >= kSmallestStep * std::abs(before)) {
        const std::size_t cycle = bins[end].first_cycle;
        description.steps.push_back({cycle, cycle, before, after, p_value});
      }
    }
    begin = end + GapOf(bins);
  }
  return description;
}

void Course::Bin::Merge(const Bin& next) {
  last_cycle = next.last_cycle;
  least = std::min(least, next.least);
  greatest = std::max(greatest, next.greatest);
  count += next.count;
  cycle += (next.cycle - cycle) * static_cast<double>(next.count) / static_cast<double>(count);
  weight += next.weight;
  const double share = next.weight / weight;
  value = value * (1 - share) + next.value * share;
}

void Course::Add(std::size_t cycle, double value, double weight) {
  const Bin one = {cycle, cycle, static_cast<double>(cycle), value, weight, value, value, 1};
  if (bins_.empty()) first_ = value;
  last_ = value;
  if (!bins_.empty() && bins_.back().count < width_) return bins_.back().Merge(one);
  if (bins_.size() == kMostBins) {
    for (std::size_t i = 0; i < kMostBins / 2; ++i) {
      bins_[i] = bins_[2 * i];
      bins_[i].Merge(bins_[2 * i + 1]);
    }
    bins_.resize(kMostBins / 2);
    width_ *= 2;
  }
  bins_.push_back(one);
}

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

std::vector<Evolution> BeginEvolutions(bool is_torsional) {
  std::vector<Evolution> evolutions;
  for (const TrackedQuantity& quantity : kQuantities) {
    const std::string_view unit = kCycleNumbers.at(PlaceOf(quantity.name)).unit;
    evolutions.push_back(
        {&quantity, report::UnitIn(report::UnitsOf(is_torsional), unit.empty() ? "-" : unit)});
  }
  return evolutions;
}

void AddTo(std::span<Evolution> evolutions, const CycleFit& fit) {
  if (fit.HasFlag("not_converged")) return;
  for (Evolution& evolution : evolutions) {
    const TrackedQuantity& quantity = *evolution.quantity;
    const std::optional<double>& value = fit[quantity.name];
    if (!value || fit.HasFlag(quantity.open_flag)) continue;
    // A value without an error is exact, held or without noise: then all have one weight.
    const std::optional<double>& error = fit[quantity.error];
    evolution.course.Add(fit.number, *value, error && *error > 0 ? WeightOf(*error) : 1.0);
  }
}

void Describe(std::vector<Evolution>& evolutions) {
  std::erase_if(evolutions, [](const Evolution& each) { return each.course.bins().empty(); });
  for (Evolution& each : evolutions) each.description = *Describe(each.course);
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
