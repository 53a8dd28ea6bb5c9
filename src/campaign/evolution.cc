#include "mindahl/campaign/evolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <ranges>
#include <utility>

#include "core/probability.h"
#include "loop/statistics.h"
#include "mindahl/report/units.h"

namespace mindahl::campaign {
namespace {

constexpr double kChance = 0.01;         // of a change, or of a trend, where there is none
constexpr double kSmallestStep = 0.02;   // [-] of the value before it
constexpr double kSmallestTrend = 0.01;  // [-] of the segment's mean
constexpr double kOfScatter = 4;         // [standard deviations] enough whatever the size
constexpr double kSettled = 0.05;        // [-] of the whole change
// Residuals are periodic, not scatter, if their variance exceeds both multiples: of the variance of
// neighbours, and of the variance about one line through all values.
constexpr double kOfNeighbours = 10;
constexpr double kOfAll = 0.25;
constexpr std::size_t kLeastBins = 4;      // of a segment: two beyond a line
constexpr std::size_t kFewestToTest = 20;  // rows in which no change is found are said to have none
constexpr std::size_t kOfAnEnd = 3;        // cycles that show how a test ends
constexpr std::size_t kMostSegments = 8;
constexpr double kExact = 1e-3;  // [-] of a value: less is no scatter

using Bins = std::span<const Course::Bin>;

/// A least-squares line through the values in bins, which takes one more at a time (West 1979):
///   y = level + slope (x − x₀)
struct Line {
  explicit Line(Bins bins) {
    for (const Course::Bin& bin : bins) Add(bin);
  }

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

/// Returns bins of as many neighbours each, the last perhaps of fewer.
std::vector<Course::Bin> InBlocks(Bins bins, std::size_t length) {
  std::vector<Course::Bin> blocks;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (i % length == 0) {
      blocks.push_back(bins[i]);
    } else {
      blocks.back().Merge(bins[i]);
    }
  }
  return blocks;
}

/// Returns the squared second differences of neighbours, over their variance at one value's of 1. A
/// trend leaves these alone, and their median disregards steps.
std::vector<double> SquaredBends(Bins bins) {
  std::vector<double> squares;
  for (std::size_t k = 2; k < bins.size(); ++k) {
    const double bend = bins[k - 2].value - 2 * bins[k - 1].value + bins[k].value;
    squares.push_back(bend * bend /
                      (1 / bins[k - 2].count + 4 / bins[k - 1].count + 1 / bins[k].count));
  }
  return squares;
}

/// Returns the variance of a value that squared bends show.
double VarianceOf(std::vector<double> squares) {
  constexpr double kMedianOfChiSquared = 0.455;  // with one degree of freedom
  return loop::Median(squares) / kMedianOfChiSquared;
}

/// Returns the least variance of a value, in as many as a bin counts.
double FloorOf(const Course::Bin& bin) { return bin.count * std::pow(kExact * bin.value, 2); }

/// Returns the bins, each counting as many values of the usual scatter as determine its mean so
/// well: by its standard errors and the scatter beyond, and by that of neighbours, the larger one.
std::vector<Course::Bin> Weighted(Bins bins) {
  std::vector<Course::Bin> weighted(bins.begin(), bins.end());
  std::vector<double> errors;
  for (const Course::Bin& bin : bins) errors.push_back(bin.squared_error);
  const double error = loop::Median(errors);
  const double usual = std::max(error, VarianceOf(SquaredBends(bins)));
  const double least = kExact * kExact * usual;
  if (!(usual > 0)) return weighted;
  for (Course::Bin& bin : weighted) {
    // A value without an error of its own has the usual one.
    const double own = bin.squared_error > 0 ? bin.squared_error : error;
    bin.count *= usual / std::max(least, usual - error + own);
  }
  const std::vector<double> squares = SquaredBends(weighted);
  const std::size_t window =
      std::min(squares.size(), std::clamp<std::size_t>(bins.size() / 8, 16, 32));
  std::vector<double> scatter;  // variance of the window that begins at each place
  for (std::size_t begin = 0; begin + window <= squares.size(); ++begin) {
    const auto own = std::span(squares).subspan(begin, window);
    scatter.push_back(VarianceOf({own.begin(), own.end()}));
  }
  for (std::size_t i = 0; i < weighted.size(); ++i) {
    const double before = scatter[std::min(std::max(i, window) - window, scatter.size() - 1)];
    const double after = scatter[std::min(i, scatter.size() - 1)];
    weighted[i].count *= usual / std::max({before, after, FloorOf(weighted[i]), least});
  }
  return weighted;
}

/// The scatter of a time history, apart from what it follows.
struct Noise {
  double variance = 0.0;  // of a value, as it counts in means over many
  double degrees = 0.0;   // of freedom of that
};

/// True if a change is worth a statement: by its size, or as it stands out of the scatter.
bool IsLarge(double change, double smallest, const Noise& noise) {
  return change >= std::min(smallest, kOfScatter * std::sqrt(noise.variance));
}

/// A part of a time history that a line describes.
struct Segment {
  Bins bins;
  Line line{bins};
  std::size_t begin = bins.front().first_cycle;

  /// Returns the line's value within what values there were.
  [[nodiscard]] double At(const Course::Bin& bin) const {
    const auto least = std::ranges::min_element(bins, {}, &Course::Bin::least)->least;
    const auto greatest = std::ranges::max_element(bins, {}, &Course::Bin::greatest)->greatest;
    return std::clamp(line.At(bin.cycle), least, greatest);
  }
  [[nodiscard]] double first() const { return At(bins.front()); }
  [[nodiscard]] double last() const { return At(bins.back()); }
};

/// Estimates it within segments, from neighbouring blocks of bins, in which correlated ones count.
/// @param bins  all of them, with their outliers
Noise NoiseWithin(std::span<const Segment> segments, Bins bins, std::size_t longest = 8) {
  constexpr std::size_t kBlocks = 16;
  const std::size_t length = std::clamp<std::size_t>(bins.size() / kBlocks, 1, longest);
  std::vector<double> squares;
  double exact = 0.0;
  for (const Segment& segment : segments) {
    const Bins own =
        bins.subspan(segment.bins.data() - segments.front().bins.data(), segment.bins.size());
    for (const Course::Bin& bin : own) exact = std::max(exact, FloorOf(bin));
    std::ranges::copy(SquaredBends(InBlocks(own, length)), std::back_inserter(squares));
  }
  if (squares.empty()) return {std::numeric_limits<double>::infinity(), 1.0};
  return {std::max(VarianceOf(squares), exact), static_cast<double>(squares.size()) / 2};
}

/// The segments whose lines have the least sum of squares for their number.
struct Division {
  double squares;
  std::vector<Segment> segments = {};
};

/// Returns the divisions of bins into one segment, two and more, as many as there are bins for and
/// squares that are numbers.
std::vector<Division> DivisionsOf(Bins bins) {
  struct Best {
    double squares = std::numeric_limits<double>::infinity();
    std::size_t begin = 0;  // of the last segment
  };
  // best[k][n] divides the first n bins into k + 1 segments.
  std::vector best(kMostSegments, std::vector<Best>(bins.size() + 1));
  for (std::size_t begin = 0; begin + kLeastBins <= bins.size(); ++begin) {
    Line line(bins.subspan(begin, kLeastBins - 1));
    for (std::size_t end = begin + kLeastBins; end <= bins.size(); ++end) {
      line.Add(bins[end - 1]);
      if (begin == 0) best[0][end].squares = line.squares();
      for (std::size_t k = 1; k < kMostSegments && begin > 0; ++k) {
        const double squares = best[k - 1][begin - 1].squares + line.squares();
        if (squares < best[k][end].squares) best[k][end] = {squares, begin};
      }
    }
  }
  std::vector<Division> divisions;
  for (std::size_t count = 1; count <= kMostSegments; ++count) {
    std::size_t end = bins.size();
    Division division{best[count - 1][end].squares};
    if (!std::isfinite(division.squares)) break;
    for (std::size_t left = count; left > 0; --left) {
      const std::size_t begin = best[left - 1][end].begin;
      division.segments.insert(division.segments.begin(), {bins.subspan(begin, end - begin)});
      end = begin - 1;  // the bin before a segment is in none
    }
    divisions.push_back(std::move(division));
  }
  return divisions;
}

/// Returns the number of segments that the F test calls for.
std::size_t CountFor(const Noise& noise, std::span<const Division> divisions, std::size_t bins) {
  constexpr double kMore = 4;  // a level, a slope, a place and the bin there
  const double chance = kChance / static_cast<double>(bins);
  const double price = kMore * noise.variance * QuantileOfF(chance, kMore, noise.degrees);
  const auto cost = [price](const Division& division) {
    return division.squares + static_cast<double>(division.segments.size() - 1) * price;
  };
  return std::ranges::min_element(divisions, {}, cost)->segments.size();
}

/// Returns the bins with each value clamped to the range of its two neighbours, and the first and
/// the last one to the range of the next two.
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
  const std::size_t first = segments.front().begin;
  const std::size_t last = segments.back().bins.back().last_cycle;
  std::size_t settled = last + 1;
  for (auto each = segments.rbegin(); settled > first; --settled) {
    while (each->begin >= settled) ++each;
    const double value = each->line.At(static_cast<double>(settled - 1));
    if (!(std::abs(value - end) <= kSettled * change)) break;
  }
  if (settled == first || 10 * (last - std::min(settled, last)) < last - first) return std::nullopt;
  return settled;
}

/// Returns the step from one segment to the next, if any: a jump at the bin between, by more than
/// slopes make of it within the shortest segment, beyond chance at one of so many places.
std::optional<Change> StepBetween(const Segment& before, const Segment& after, const Noise& noise,
                                  std::size_t places) {
  const Course::Bin& between = *(after.bins.data() - 1);
  const double from = before.line.At(between.cycle);
  const double to = after.line.At(between.cycle);
  // The bin between is a mixture of both levels, by their cycles.
  const auto cycles = static_cast<double>(between.last_cycle + 1 - between.first_cycle);
  const double share = std::clamp((between.value - to) / (from - to), 0.0, 1.0);
  const double steepest = std::max(std::abs(before.line.slope()), std::abs(after.line.slope()));
  const double width =
      static_cast<double>(kLeastBins) * (before.bins[1].cycle - before.bins[0].cycle);
  const double jump = std::abs(to - from);
  const double error = std::sqrt(
      noise.variance * (before.line.VarianceAt(between) + after.line.VarianceAt(between)));
  const double p_value =
      std::min(1.0, static_cast<double>(places) * PValueOfT(jump / error, noise.degrees));
  const bool is_large = IsLarge(jump, kSmallestStep * std::abs(from), noise);
  if (!(is_large && jump > width * steepest && p_value < kChance)) return {};
  const std::size_t place =
      between.first_cycle + static_cast<std::size_t>(std::lround(cycles * share));
  return Change{place, place, before.last(), after.first(), p_value};
}

constexpr std::array kQuantities = {
    TrackedQuantity{"friction_coefficient", "μ", "slip_force"},
    TrackedQuantity{"slip_force", "Tc", "slip_force"},
    TrackedQuantity{"half_gap", "half gap", ""},
    TrackedQuantity{"sigma", "σ", "sigma"},
    TrackedQuantity{"contact_radius", "a", "sigma"},
    TrackedQuantity{"alpha", "", "alpha"},
    TrackedQuantity{"energy", "", ""},
    TrackedQuantity{"energy_ratio", "", ""},
};

/// Returns "+60 %"; nothing where the sign changes or it grows more than tenfold.
std::string RelativeChange(double from, double to) {
  constexpr double kMost = 10;
  const double change = to / from - 1;
  if (!(change > -1 && change < kMost)) return "";
  return fmt::format("{:+.{}f} %", 100 * change, std::abs(change) < 0.1 ? 1 : 0);
}

/// Returns "0.352 → 0.600" or "250 → 400 µm"; one value where both have the same digits: three, or
/// as many as show a smaller error.
std::string FromTo(double from, double to, const std::string& unit,
                   const std::string& between = " → ",
                   double error = std::numeric_limits<double>::infinity()) {
  const double largest = std::max(std::abs(from), std::abs(to));
  const report::ScaledUnit scaled = report::UnitFor(unit, largest);
  const auto text = [&](double value) {
    return report::RoundedTo(std::min(largest / 10, error) / scaled.factor, value / scaled.factor);
  };
  return scaled.Behind(text(from) + (text(to) == text(from) ? "" : between + text(to)));
}

/// Returns "varies from 10.5 to 19.5 N", with as many digits as tell the ends apart.
std::string Variation(double least, double greatest, const std::string& unit) {
  return "varies from " + FromTo(least, greatest, unit, " to ", greatest - least);
}

}  // namespace

void Course::Bin::Merge(const Bin& next) {
  last_cycle = next.last_cycle;
  least = std::min(least, next.least);
  greatest = std::max(greatest, next.greatest);
  count += next.count;
  squared_error += (next.squared_error - squared_error) * next.count / count;
  cycle += (next.cycle - cycle) * next.count / count;
  value += (next.value - value) * next.count / count;
}

void Course::Add(std::size_t cycle, double value, std::size_t cycles, double error) {
  const auto number = static_cast<double>(cycle);
  const Bin one = {cycle, cycle + cycles - 1, number, value, value, value, 1, error * error};
  if (bins_.empty()) first_ = value;
  last_ = value;
  if (!bins_.empty() && bins_.back().count < width_) return bins_.back().Merge(one);
  if (bins_.size() == kMostBins) {
    bins_ = InBlocks(bins_, 2);
    width_ *= 2;
  }
  bins_.push_back(one);
}

CourseDescription Describe(const Course& course) {
  const std::size_t rows = course.bins().size();
  CourseDescription description = {.from = course.first(), .to = course.last()};
  if (rows < 2 * kLeastBins) return description;
  const std::vector<Course::Bin> weighted = Weighted(course.bins());
  const std::vector<Course::Bin> bins = WithoutOutliers(weighted);
  const std::vector<Division> divisions = DivisionsOf(bins);
  if (divisions.empty()) return description;  // squares are no doubles
  const double neighbours = NoiseWithin(divisions.front().segments, weighted, 1).variance;
  Noise noise;
  std::size_t count = 0;
  // Steps in more than half of the blocks count as scatter, unless the segments divide these.
  for (const Division& trial : divisions) {
    Noise within = NoiseWithin(trial.segments, weighted);
    within.variance = std::max(within.variance, neighbours);
    const std::size_t called_for = CountFor(within, divisions, bins.size());
    if (std::isnormal(within.variance) && called_for > count &&
        called_for >= trial.segments.size()) {
      noise = within;
      count = called_for;
    }
  }
  if (count == 0) return description;  // all are 0
  std::vector<Segment> segments = divisions[count - 1].segments;
  double squares = 0.0;
  std::vector<Change>& changes = description.changes;
  const Segment* before = nullptr;
  for (Segment& segment : segments) {
    Line& line = segment.line;
    const double p_value =
        PValueOfT(line.slope() / std::sqrt(noise.variance / line.spread), noise.degrees);
    const bool is_large = IsLarge(std::abs(segment.last() - segment.first()),
                                  kSmallestTrend * std::abs(line.level), noise);
    if (!(p_value < kChance && is_large)) line.product = 0;
    squares += line.squares();
    std::optional<Change> step;
    if (before != nullptr) step = StepBetween(*before, segment, noise, bins.size());
    if (step) {
      changes.push_back(*step);
      segment.begin = step->first_cycle;
    }
    if (before != nullptr && !step && before->line.slope() * line.slope() > 0) {
      Change& trend = changes.back();
      trend = {trend.first_cycle, segment.bins.back().last_cycle, trend.from, segment.last(),
               std::min(trend.p_value, p_value)};
    } else if (line.slope() != 0) {
      changes.push_back({segment.begin, segment.bins.back().last_cycle, segment.first(),
                         segment.last(), p_value});
    }
    before = &segment;
  }
  description.varies = rows >= kFewestToTest &&
                       squares > kOfNeighbours * neighbours * static_cast<double>(rows) &&
                       squares > kOfAll * Line(bins).square;
  if (description.varies) {
    changes.clear();
    const auto [least, greatest] = std::ranges::minmax(bins, {}, &Course::Bin::value);
    description.from = least.value;
    description.to = greatest.value;
  } else if (description.changed()) {
    description.settled_at = SettledAt(segments);
    const auto without_scatter = [&](double value, double on_line, double weight) {
      const double scatter = std::sqrt(noise.variance / weight);
      return std::abs(value - on_line) < kOfScatter * scatter ? on_line : value;
    };
    description.from = without_scatter(course.first(), segments.front().first(),
                                       weighted.front().count / course.bins().front().count);
    description.to = without_scatter(course.last(), segments.back().last(),
                                     weighted.back().count / course.bins().back().count);
  } else if (rows >= kFewestToTest) {
    description.from = description.to = Line(weighted).level;
  }
  return description;
}

std::vector<Evolution> BeginEvolutions(bool is_torsional) {
  std::vector<Evolution> evolutions;
  for (const TrackedQuantity& quantity : kQuantities) {
    const std::string_view unit = kCycleNumbers.at(PlaceOf(quantity.name)).unit;
    evolutions.push_back(
        {&quantity, is_torsional ? report::UnitOfTorque(unit) : std::string(unit)});
  }
  return evolutions;
}

void AddTo(std::span<Evolution> evolutions, const CycleFit& fit) {
  if (fit.HasFlag("not_converged") || fit.HasFlag("rows_missing")) return;
  for (Evolution& evolution : evolutions) {
    const TrackedQuantity& quantity = *evolution.quantity;
    const std::string parameter(quantity.parameter);
    const std::optional<double>& value = fit[quantity.name];
    if (!value || !std::isfinite(*value) || fit.HasFlag(parameter + "_open")) continue;
    ++evolution.known;
    // A quotient of a parameter has the parameter's relative error.
    double error = 0.0;
    if (!parameter.empty() && fit[parameter]) {
      error = fit[parameter + "_error"].value_or(0.0) * std::abs(*value / *fit[parameter]);
    }
    evolution.course.Add(fit.number, *value, fit.cycles, std::isfinite(error) ? error : 0.0);
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
    const bool is_of_few = 2 * each.known < most;
    if (!is_of_few) each.description = Describe(each.course);
    const std::size_t three_rows = kOfAnEnd * last / most;
    each.is_of_whole_test = !is_of_few && each.course.bins().back().last_cycle + three_rows > last;
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
    const bool is_force = quantity.parameter == "slip_force" || quantity.name == "half_gap";
    if (is_force && std::exchange(has_force, true)) continue;
    text += fmt::format("{}{} ", text.empty() ? "" : "; ", quantity.symbol);
    if (course.varies) {
      text += Variation(course.from, course.to, evolution.unit);
    } else if (course.changed()) {
      std::string change;
      if (quantity.name == "sigma") change = RelativeChange(course.from, course.to);
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
  constexpr double kLeastChance = 1e-12;                   // no p-value is 0
  std::vector<std::pair<double, std::string>> statements;  // with sizes over the larger end
  const auto add = [&statements](double from, double to, std::string statement) {
    const double size = std::abs(to - from) / std::max(std::abs(from), std::abs(to));
    statements.emplace_back(size, std::move(statement));
  };
  for (const Evolution& evolution : evolutions) {
    if (const CourseDescription& course = evolution.description; course.varies) {
      add(course.from, course.to,
          fmt::format("{}: {}, with no lasting step or trend", evolution.quantity->name,
                      Variation(course.from, course.to, evolution.unit)));
    }
    for (const auto& change : evolution.description.changes) {
      const auto& [first, last, from, to, p_value] = change;
      const std::string relative = RelativeChange(from, to);
      add(from, to,
          fmt::format("{}: {}, {}{}, {}", evolution.quantity->name,
                      change.is_step() ? fmt::format("a step at cycle {}", first)
                                       : fmt::format("cycles {} to {}", first, last),
                      FromTo(from, to, evolution.unit),
                      relative.empty() ? "" : " (" + relative + ")",
                      p_value < kLeastChance ? "p < 1e-12" : fmt::format("p = {:.1g}", p_value)));
    }
  }
  std::ranges::stable_sort(statements, std::greater<>(), &std::pair<double, std::string>::first);
  if (statements.size() > kMost) {
    const std::size_t more = statements.size() - (kMost - 1);
    statements.resize(kMost);
    statements.back().second = fmt::format("and {} smaller ones, which --json lists", more);
  }
  const auto texts = statements | std::views::values;
  return {texts.begin(), texts.end()};
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
    const auto mark = [&panel](std::string_view what, std::size_t cycle) {
      panel.marks.push_back(
          {.x = static_cast<double>(cycle), .label = fmt::format("{}, {}", what, cycle)});
    };
    for (const Change& change : evolution.description.changes) {
      if (change.is_step()) mark("step", change.first_cycle);
    }
    if (const auto settled = evolution.description.settled_at) mark("settled", *settled);
  }
  return panels;
}

io::PlotPanel FrettingLog(std::span<const Cycle> cycles, bool is_torsional) {
  io::PlotPanel panel;
  for (const Cycle& cycle : cycles) {
    panel.series.push_back({.label = fmt::format("cycle {}", cycle.number),
                            .x = cycle.record.displacement,
                            .y = cycle.record.force,
                            .shade = static_cast<double>(panel.series.size()) /
                                     std::max(static_cast<double>(cycles.size()) - 1, 1.0)});
  }
  const report::Units units = report::UnitsOf(is_torsional);
  report::ScaleAxes(panel, is_torsional ? "angle" : "displacement", units.displacement,
                    is_torsional ? "torque" : "force", units.force);
  return panel;
}

}  // namespace mindahl::campaign
