#include "mindahl/campaign/evolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <optional>
#include <utility>

#include "core/probability.h"
#include "mindahl/report/units.h"

namespace mindahl::campaign {

namespace {

constexpr double kChance = 0.01;           // of a change, or of a trend, where there is none
constexpr double kSmallestStep = 0.02;     // [-] of the value before it
constexpr double kSmallestTrend = 0.01;    // [-] of the segment's mean
constexpr double kOfScatter = 4;           // [standard deviations] enough whatever the size
constexpr double kSettled = 0.05;          // [-] of the whole change
constexpr std::size_t kLeastBins = 4;      // of a segment: two beyond a line
constexpr std::size_t kFewestToTest = 20;  // rows in which no change is found are said to have none
constexpr std::size_t kOfAnEnd = 3;        // bins or cycles that show how a test begins or ends
constexpr int kDepth = 3;                  // up to eight segments

using Bins = std::span<const Course::Bin>;

/// A least-squares line through the values in bins, which takes one more at a time (West 1979):
///   y = level + slope (x − x₀)
struct Line {
  double x0 = 0.0;
  double level = 0.0;
  double count = 0.0;
  double spread = 0.0;   // Σ(x − x₀)²
  double product = 0.0;  // Σ(x − x₀)(y − level)
  double square = 0.0;   // Σ(y − level)²

  void Add(const Course::Bin& bin) {
    count += bin.count;
    const double x = bin.cycle - x0;
    const double y = bin.value - level;
    x0 += bin.count / count * x;
    level += bin.count / count * y;
    spread += bin.count * x * (bin.cycle - x0);
    product += bin.count * x * (bin.value - level);
    square += bin.count * y * (bin.value - level);
  }

  [[nodiscard]] double slope() const { return spread > 0 ? product / spread : 0.0; }
  /// Returns Σ(y − line)².
  [[nodiscard]] double squares() const { return square - slope() * product; }
  [[nodiscard]] double At(double x) const { return level + slope() * (x - x0); }
  /// Returns the variance of its value at a bin, over that of a value.
  [[nodiscard]] double VarianceAt(const Course::Bin& bin) const {
    return 1 / count + (slope() == 0 ? 0.0 : (bin.cycle - x0) * (bin.cycle - x0) / spread);
  }
};

Line LineThrough(Bins bins) {
  Line line;
  for (const Course::Bin& bin : bins) line.Add(bin);
  return line;
}

/// The scatter of a time history, apart from what it follows.
struct Noise {
  double variance = 0.0;  // of a value, as it counts in means over many
  double degrees = 0.0;   // of freedom of that
};

/// Estimates it from second differences of the means of neighbouring blocks: a
/// trend leaves these alone, their median disregards steps, and in blocks of
/// eight bins correlated ones count.
Noise NoiseOf(Bins bins) {
  constexpr std::size_t kLongest = 8;
  constexpr std::size_t kBlocks = 16;
  constexpr double kMedianOfChiSquared = 0.455;  // with one degree of freedom
  constexpr double kExact = 1e-3;                // of a value: less is no scatter
  const std::size_t length = std::clamp<std::size_t>(bins.size() / kBlocks, 1, kLongest);
  std::vector<Course::Bin> blocks;
  double exact = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (i % length > 0) {
      blocks.back().Merge(bins[i]);
    } else {
      blocks.push_back(bins[i]);
    }
    exact = std::max(exact, bins[i].count * std::pow(kExact * bins[i].value, 2));
  }
  std::vector<double> squares;
  for (std::size_t k = 2; k < blocks.size(); ++k) {
    const double bend = blocks[k - 2].value - 2 * blocks[k - 1].value + blocks[k].value;
    squares.push_back(bend * bend /
                      (1 / blocks[k - 2].count + 4 / blocks[k - 1].count + 1 / blocks[k].count));
  }
  const double degrees = static_cast<double>(squares.size()) / 2;
  const double variance = boost::math::statistics::median(squares) / kMedianOfChiSquared;
  return {std::max(variance, exact), degrees};
}

/// True if a change is worth a statement: by its size, or as it stands out of the scatter.
bool IsLarge(double change, double smallest, const Noise& noise) {
  return change >= std::min(smallest, kOfScatter * std::sqrt(noise.variance));
}

/// A part of a time history that a line describes.
struct Segment {
  Bins bins;
  Line line;

  /// Returns the line's value within what values there were.
  [[nodiscard]] double At(const Course::Bin& bin) const {
    const auto least = std::ranges::min_element(bins, {}, &Course::Bin::least)->least;
    const auto greatest = std::ranges::max_element(bins, {}, &Course::Bin::greatest)->greatest;
    return std::clamp(line.At(bin.cycle), least, greatest);
  }
  [[nodiscard]] double first() const { return At(bins.front()); }
  [[nodiscard]] double last() const { return At(bins.back()); }
  [[nodiscard]] double DistanceOf(const Course::Bin& bin) const {
    return std::abs(bin.value - line.At(bin.cycle));
  }
  /// Returns by how much the line misses the values, beyond their scatter: of a curve.
  [[nodiscard]] double Misfit(const Noise& noise) const {
    const double squares = line.squares() / static_cast<double>(bins.size());
    return std::sqrt(std::max(0.0, squares - noise.variance) / bins.front().count);
  }
};

/// Appends the segments of these bins. The bin between two segments is in the line of neither, as
/// what changes within a cycle makes it a mixture of both; the nearer has it.
void Divide(Bins bins, const Noise& noise, int depth, std::vector<Segment>& segments) {
  Line one;
  std::vector<double> squares;  // of the lines through so many bins and through the others
  for (const Course::Bin& bin : bins) {
    squares.push_back(one.squares());
    one.Add(bin);
  }
  Line others;
  std::size_t place = 0;
  double least = one.squares();
  for (std::size_t k = bins.size() - 1; depth > 0 && k >= kLeastBins; --k) {
    squares[k] += others.squares();
    others.Add(bins[k]);
    if (squares[k] < least && k + kLeastBins < bins.size()) {
      least = squares[k];
      place = k;
    }
  }
  constexpr double kMore = 4;  // a level, a slope, a place and the bin there
  const double f = (one.squares() - least) / kMore / noise.variance;
  // Squares of numbers near the largest double overflow.
  const double p_value =
      place == 0 || !std::isfinite(f)
          ? 1.0
          : std::min(1.0, static_cast<double>(bins.size()) * PValueOfF(f, kMore, noise.degrees));
  if (p_value < kChance) {
    Divide(bins.first(place), noise, depth - 1, segments);
    const std::size_t next = segments.size();
    Divide(bins.subspan(place + 1), noise, depth - 1, segments);
    Segment& before = segments[next - 1];
    Segment& after = segments[next];
    if (before.DistanceOf(bins[place]) < after.DistanceOf(bins[place])) {
      before.bins = {before.bins.data(), before.bins.size() + 1};
    } else {
      after.bins = {after.bins.data() - 1, after.bins.size() + 1};
    }
    return;
  }
  segments.push_back({bins, one});
}

/// Returns the bins, each with the median of it and its neighbours, of an end the next two: one
/// alone that is off is none.
std::vector<Course::Bin> WithoutOutliers(Bins bins) {
  std::vector<Course::Bin> kept(bins.begin(), bins.end());
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const Course::Bin& one = bins[i == 0 ? 2 : i - 1];
    const Course::Bin& other = bins[i + 1 == bins.size() ? i - 2 : i + 1];
    const auto [low, high] = std::minmax(one.value, other.value);
    kept[i].value = std::clamp(bins[i].value, low, high);
  }
  return kept;
}

/// Returns where segments stay near to their end.
std::optional<std::size_t> SettledAt(std::span<const Segment> segments) {
  const double end = segments.back().last();
  double change = 0.0;
  for (const Segment& each : segments) {
    change = std::max({change, std::abs(each.first() - end), std::abs(each.last() - end)});
  }
  const std::size_t last = segments.back().bins.back().last_cycle;
  const std::size_t first = segments.front().bins.front().first_cycle;
  std::optional<std::size_t> settled;
  for (const Segment& each : segments) {
    for (const Course::Bin& bin : each.bins) {
      const bool is_near = std::abs(each.line.At(bin.cycle) - end) <= kSettled * change;
      settled = is_near ? settled.value_or(bin.first_cycle) : std::optional<std::size_t>();
    }
  }
  if (!settled || *settled == first || 10 * (last - *settled) < last - first) return std::nullopt;
  return settled;
}

/// Returns the first cycle after a step: in the bin that is a mixture of both
/// levels, by their shares.
std::size_t PlaceOfStep(const Segment& before, const Segment& after) {
  const Course::Bin& last = before.bins.back();
  const Course::Bin& first = after.bins.front();
  const Course::Bin& mixed = before.DistanceOf(last) > after.DistanceOf(first) ? last : first;
  const double to = after.line.At(mixed.cycle);
  const double share = (mixed.value - to) / (before.line.At(mixed.cycle) - to);
  const auto cycles = static_cast<double>(mixed.last_cycle + 1 - mixed.first_cycle);
  return mixed.first_cycle +
         static_cast<std::size_t>(std::lround(cycles * std::clamp(share, 0.0, 1.0)));
}

/// Returns the step from one segment to the next where there is one: a jump by
/// more than slopes make of it within the shortest segment and lines miss of a
/// curve, and beyond chance at one of so many places.
std::optional<Change> StepBetween(const Segment& before, const Segment& after, const Noise& noise,
                                  std::size_t places) {
  Change step = {.from = before.last(), .to = after.first()};
  const double jump = std::abs(step.to - step.from);
  if (!(jump > kOfScatter * std::max(before.Misfit(noise), after.Misfit(noise)))) return {};
  step.first_cycle = step.last_cycle = PlaceOfStep(before, after);
  const double steepest = std::max(std::abs(before.line.slope()), std::abs(after.line.slope()));
  const double width = static_cast<double>(kLeastBins) * before.bins.front().count;
  const double error = std::sqrt(noise.variance * (before.line.VarianceAt(before.bins.back()) +
                                                   after.line.VarianceAt(after.bins.front())));
  step.p_value =
      std::min(1.0, static_cast<double>(places) * PValueOfT(jump / error, noise.degrees));
  const bool is_large =
      IsLarge(jump, kSmallestStep * std::abs(step.from), noise) && jump > width * steepest;
  return is_large && step.p_value < kChance ? std::optional(step) : std::nullopt;
}

constexpr std::array kQuantities = {
    TrackedQuantity{"friction_coefficient", "μ", ""},
    TrackedQuantity{"slip_force", "Tc", "slip_force_open"},
    TrackedQuantity{"half_gap", "half gap", ""},
    TrackedQuantity{"sigma", "σ", "sigma_open"},
    TrackedQuantity{"contact_radius", "a", "sigma_open"},
    TrackedQuantity{"alpha", "", "alpha_open"},
    TrackedQuantity{"energy", "", ""},
    TrackedQuantity{"energy_ratio", "", ""},
};

/// Returns "p = 0.01"; no p-value is 0.
std::string ChanceText(double p_value) {
  constexpr double kLeast = 1e-12;
  return p_value < kLeast ? "p < 1e-12" : fmt::format("p = {:.1g}", p_value);
}

/// Returns "+60 %"; nothing where the sign changes or it grows more than
/// tenfold.
std::string RelativeChange(double from, double to) {
  constexpr double kMost = 10;
  const double change = to / from - 1;
  if (!(change > -1 && change < kMost)) return "";
  return fmt::format("{:+.{}f} %", 100 * change, std::abs(change) < 0.1 ? 1 : 0);
}

/// Returns "0.352 → 0.600" or "250 → 400 µm"; one value where both have the same three digits.
std::string FromTo(double from, double to, const std::string& unit) {
  const double largest = std::max(std::abs(from), std::abs(to));
  const report::ScaledUnit scaled = report::UnitFor(unit, largest);
  const auto text = [&](double value) {
    return report::RoundedTo(largest / 10 / scaled.factor, value / scaled.factor);
  };
  return scaled.Behind(text(from) + (text(to) == text(from) ? "" : " → " + text(to)));
}

}  // namespace

void Course::Bin::Merge(const Bin& next) {
  last_cycle = next.last_cycle;
  least = std::min(least, next.least);
  greatest = std::max(greatest, next.greatest);
  count += next.count;
  cycle += (next.cycle - cycle) * next.count / count;
  value += (next.value - value) * next.count / count;
}

void Course::Add(std::size_t cycle, double value, std::size_t cycles) {
  const auto number = static_cast<double>(cycle);
  const Bin one = {cycle, cycle + cycles - 1, number, value, value, value, 1};
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

CourseDescription Describe(const Course& course) {
  const std::size_t rows = course.bins().size();
  const std::size_t of_an_end = std::clamp<std::size_t>(rows / 2, 1, kOfAnEnd);
  CourseDescription description;
  if (rows == 0) return description;
  description.from = LineThrough(course.bins().first(of_an_end)).level;
  description.to = LineThrough(course.bins().last(of_an_end)).level;
  if (rows < 2 * kLeastBins) return description;
  const std::vector<Course::Bin> bins = WithoutOutliers(course.bins());
  const Noise noise = NoiseOf(course.bins());
  if (!(noise.variance > 0)) return description;  // all are 0
  std::vector<Segment> segments;
  Divide(bins, noise, kDepth, segments);
  std::vector<Change>& changes = description.changes;
  const Segment* before = nullptr;
  for (Segment& segment : segments) {
    Line& line = segment.line;
    const double p_value =
        PValueOfT(line.slope() / std::sqrt(noise.variance / line.spread), noise.degrees);
    const bool is_large = IsLarge(std::abs(segment.last() - segment.first()),
                                  kSmallestTrend * std::abs(line.level), noise);
    if (!(p_value < kChance && is_large)) line.product = 0;
    std::optional<Change> step;
    if (before != nullptr) step = StepBetween(*before, segment, noise, bins.size());
    if (step) changes.push_back(*step);
    if (before != nullptr && !step && before->line.slope() * line.slope() > 0) {
      changes.back().last_cycle = segment.bins.back().last_cycle;
      changes.back().to = segment.last();
      changes.back().p_value = std::min(changes.back().p_value, p_value);
    } else if (line.slope() != 0) {
      changes.push_back({segment.bins.front().first_cycle, segment.bins.back().last_cycle,
                         segment.first(), segment.last(), p_value});
    }
    before = &segment;
  }
  if (description.changed()) {
    description.settled_at = SettledAt(segments);
  } else if (rows >= kFewestToTest) {
    description.from = description.to = LineThrough(course.bins()).level;
  }
  return description;
}

std::vector<Evolution> BeginEvolutions(bool is_torsional) {
  std::vector<Evolution> evolutions;
  for (const TrackedQuantity& quantity : kQuantities) {
    const std::string_view own = kCycleNumbers.at(PlaceOf(quantity.name)).unit;
    const std::string_view unit = own.empty() ? "-" : own;
    evolutions.push_back(
        {&quantity, is_torsional ? report::UnitOfTorque(unit) : std::string(unit)});
  }
  return evolutions;
}

void AddTo(std::span<Evolution> evolutions, const CycleFit& fit) {
  for (Evolution& evolution : evolutions) {
    const TrackedQuantity& quantity = *evolution.quantity;
    const std::optional<double>& value = fit[quantity.name];
    if (!value || !std::isfinite(*value) || fit.HasFlag(quantity.open_flag) ||
        fit.HasFlag("not_converged") || fit.HasFlag("rows_missing")) {
      continue;
    }
    ++evolution.known;
    evolution.course.Add(fit.number, *value, fit.cycles);
  }
}

void Describe(std::vector<Evolution>& evolutions) {
  std::erase_if(evolutions, [](const Evolution& each) { return each.course.bins().empty(); });
  std::size_t most = 0;
  std::size_t last = 0;
  for (const Evolution& each : evolutions) {
    most = std::max(most, each.known);
    last = std::max(last, each.course.bins().back().last_cycle);
  }
  for (Evolution& each : evolutions) {
    each.description = Describe(each.course);
    const bool is_of_few = 2 * each.known < most;
    const std::size_t three_rows = kOfAnEnd * last / most;
    each.is_of_whole_test = !is_of_few && each.course.bins().back().last_cycle + three_rows > last;
    if (!is_of_few) continue;
    each.description.changes.clear();
    each.description.settled_at.reset();
  }
  std::ranges::stable_partition(evolutions, &Evolution::is_of_whole_test);
}

std::string Headline(std::span<const Evolution> evolutions) {
  std::string text;
  bool has_force = false;
  for (const Evolution& evolution : evolutions) {
    const TrackedQuantity& quantity = *evolution.quantity;
    const CourseDescription& course = evolution.description;
    if (quantity.symbol.empty() || !evolution.is_of_whole_test) continue;
    const bool is_force = quantity.name == "friction_coefficient" ||
                          quantity.name == "slip_force" || quantity.name == "half_gap";
    if (is_force && std::exchange(has_force, true)) continue;
    text += fmt::format("{}{} ", text.empty() ? "" : "; ", quantity.symbol);
    if (course.changed()) {
      const bool in_percent = quantity.name == "sigma";
      const std::string change = in_percent ? RelativeChange(course.from, course.to) : "";
      text += change.empty() ? FromTo(course.from, course.to, evolution.unit) : change;
    } else if (evolution.course.bins().size() >= kFewestToTest) {
      text += FromTo(course.from, course.from, evolution.unit) + " throughout, but for scatter";
    } else {
      text += FromTo(course.from, course.to, evolution.unit) + ", in too few rows to test";
    }
    if (course.settled_at) text += fmt::format(", settled at cycle {}", *course.settled_at);
  }
  return text;
}

std::vector<std::string> ChangeStatements(std::span<const Evolution> evolutions) {
  constexpr std::size_t kMost = 10;
  std::vector<std::pair<double, std::string>> statements;  // with the relative sizes
  for (const Evolution& evolution : evolutions) {
    for (const auto& change : evolution.description.changes) {
      const auto& [first, last, from, to, p_value] = change;
      const std::string relative = RelativeChange(from, to);
      statements.emplace_back(
          std::abs(to - from) / std::max(std::abs(from), std::abs(to)),
          fmt::format("{}: {}, {}{}, {}", evolution.quantity->name,
                      change.is_step() ? fmt::format("a step at cycle {}", first)
                                       : fmt::format("cycles {} to {}", first, last),
                      FromTo(from, to, evolution.unit),
                      relative.empty() ? "" : " (" + relative + ")", ChanceText(p_value)));
    }
  }
  std::ranges::stable_sort(statements, std::greater<>(), &std::pair<double, std::string>::first);
  if (statements.size() > kMost) {
    const std::size_t more = statements.size() - (kMost - 1);
    statements.resize(kMost);
    statements.back().second = fmt::format("and {} smaller ones, which --json lists", more);
  }
  std::vector<std::string> lines;
  for (auto& [size, statement] : statements) lines.push_back(std::move(statement));
  return lines;
}

std::vector<io::PlotPanel> EvolutionPanels(std::span<const Evolution> evolutions) {
  constexpr double kShade = 0.3;  // of what is measured
  constexpr double kManyCycles = 100;
  std::vector<io::PlotPanel> panels;
  for (const Evolution& evolution : evolutions) {
    const std::span<const Course::Bin> bins = evolution.course.bins();
    if (bins.size() < 2) continue;
    io::PlotPanel& panel = panels.emplace_back();
    panel.log_x = bins.back().cycle >= kManyCycles * bins.front().cycle;
    io::PlotSeries course{.shade = kShade};
    io::PlotSeries range{.style = io::PlotStyle::kArea, .shade = kShade};  // up there, down back
    for (const Course::Bin& bin : bins) {
      course.x.push_back(bin.cycle);
      course.y.push_back(bin.value);
      range.y.push_back(bin.greatest);
    }
    range.x = course.x;
    range.x.insert(range.x.end(), course.x.rbegin(), course.x.rend());
    for (std::size_t k = bins.size(); k-- > 0;) range.y.push_back(bins[k].least);
    panel.series = {std::move(range), std::move(course)};
    report::ScaleAxes(panel, "cycle", "-", evolution.quantity->name, evolution.unit);
    for (const Change& step : evolution.description.changes) {
      if (!step.is_step()) continue;
      panel.marks.push_back({.x = static_cast<double>(step.first_cycle),
                             .label = fmt::format("step, {}", step.first_cycle)});
    }
    if (const std::optional<std::size_t> settled = evolution.description.settled_at) {
      panel.marks.push_back(
          {.x = static_cast<double>(*settled), .label = fmt::format("settled, {}", *settled)});
    }
  }
  return panels;
}

io::PlotPanel FrettingLog(std::span<const Cycle> cycles, bool is_torsional) {
  io::PlotPanel panel;
  for (const Cycle& cycle : cycles) {
    io::PlotSeries loop{.label = fmt::format("cycle {}", cycle.number),
                        .x = cycle.record.displacement,
                        .y = cycle.record.force};
    loop.shade = static_cast<double>(panel.series.size()) /
                 static_cast<double>(std::max<std::size_t>(cycles.size() - 1, 1));
    panel.series.push_back(std::move(loop));
  }
  const report::Units& units = report::UnitsOf(is_torsional);
  report::ScaleAxes(panel, is_torsional ? "angle" : "displacement", units.displacement,
                    is_torsional ? "torque" : "force", units.force);
  return panel;
}

}  // namespace mindahl::campaign
