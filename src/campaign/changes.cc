#include <algorithm>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/probability.h"
#include "mindahl/campaign/evolution.h"

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

}  // namespace mindahl::campaign
