#include "mindahl/campaign/changes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace mindahl::campaign {
namespace {

constexpr std::size_t kMostStretches = 6;
constexpr std::size_t kLeastBins = 4;  // of a stretch: two beyond a line
constexpr double kChiSquared95 = 3.841458820694124;

/// A line through bins: y = level + slope (x − x₀).
struct Line {
  double x0 = 0.0;
  double level = 0.0;
  double slope = 0.0;
  double spread = 0.0;   // Σw(x − x₀)²
  double squares = 0.0;  // Σw(y − line)²

  [[nodiscard]] double At(double x) const { return level + slope * (x - x0); }
};

/// Least-squares lines through any run of bins from sums up to each, weights over their mean.
class Lines {
 public:
  explicit Lines(std::span<const Course::Bin> bins) : sums_(bins.size() + 1) {
    double total = 0.0;
    for (const Course::Bin& bin : bins) {
      total += bin.weight;
      x_centre_ += bin.cycle / static_cast<double>(bins.size());
      y_centre_ += bin.value / static_cast<double>(bins.size());
    }
    const double mean_weight = total / static_cast<double>(bins.size());
    for (std::size_t i = 0; i < bins.size(); ++i) {
      const long double w = bins[i].weight / mean_weight;
      const long double x = bins[i].cycle - x_centre_;
      const long double y = bins[i].value - y_centre_;
      const Sums& s = sums_[i];
      sums_[i + 1] = {s.w + w,          s.x + w * x,      s.y + w * y,
                      s.xx + w * x * x, s.xy + w * x * y, s.yy + w * y * y};
    }
  }

  [[nodiscard]] Line Of(std::size_t begin, std::size_t end) const {
    const Sums& a = sums_[begin];
    const Sums& b = sums_[end];
    const long double w = b.w - a.w;
    const long double x = (b.x - a.x) / w;
    const long double y = (b.y - a.y) / w;
    const long double xx = b.xx - a.xx - w * x * x;
    const long double xy = b.xy - a.xy - w * x * y;
    const long double yy = b.yy - a.yy - w * y * y;
    const long double slope = xx > 0 ? xy / xx : 0;
    return {.x0 = static_cast<double>(x) + x_centre_,
            .level = static_cast<double>(y) + y_centre_,
            .slope = static_cast<double>(slope),
            .spread = static_cast<double>(xx),
            .squares = std::max(0.0, static_cast<double>(yy - slope * xy))};
  }

  /// Σw(y − mean)² of all.
  [[nodiscard]] double total_squares() const {
    const Line all = Of(0, sums_.size() - 1);
    return all.squares + all.slope * all.slope * all.spread;
  }

 private:
  struct Sums {
    long double w, x, y, xx, xy, yy;
  };
  std::vector<Sums> sums_;
  double x_centre_ = 0.0;
  double y_centre_ = 0.0;
};

/// The best cut into k stretches, k = 1 …: where each begins, and the squares that are left.
struct Cut {
  std::vector<std::size_t> begins;
  double squares = 0.0;
};

std::vector<Cut> BestCuts(const Lines& lines, std::size_t bins) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const std::size_t most = std::clamp<std::size_t>(bins / (2 * kLeastBins), 1, kMostStretches);
  // Of k + 1 stretches up to before bin j: the least squares, and where the last begins.
  std::vector<std::vector<double>> squares(most, std::vector<double>(bins + 1, kNone));
  std::vector<std::vector<std::size_t>> last(most, std::vector<std::size_t>(bins + 1, 0));
  for (std::size_t j = 1; j <= bins; ++j) {
    squares[0][j] = lines.Of(0, j).squares;
    // The line over [i, j) is the last stretch of cuts into any number.
    for (std::size_t i = kLeastBins; i + kLeastBins <= j; ++i) {
      const double of_line = lines.Of(i, j).squares;
      for (std::size_t k = 1; k < most && k * kLeastBins <= i; ++k) {
        const double sum = squares[k - 1][i] + of_line;
        if (sum < squares[k][j]) {
          squares[k][j] = sum;
          last[k][j] = i;
        }
      }
    }
  }
  std::vector<Cut> cuts;
  for (std::size_t k = 0; k < most; ++k) {
    Cut& cut = cuts.emplace_back(Cut{.begins = {}, .squares = squares[k][bins]});
    std::size_t end = bins;
    for (std::size_t stretch = k; stretch > 0; --stretch) {
      end = last[stretch][end];
      cut.begins.insert(cut.begins.begin(), end);
    }
    cut.begins.insert(cut.begins.begin(), 0);
  }
  return cuts;
}

/// n bins tell as much as n (1 − φ)/(1 + φ) independent ones, φ the residuals' lag-one correlation.
/// Lines take of it about as many nths as they have parameters and places, three a stretch, and the
/// estimate itself 1 + 3φ (Marriott & Pope 1954).
double ShareOfIndependent(std::span<const Course::Bin> bins, const Lines& lines, const Cut& cut) {
  double squares = 0.0;
  double products = 0.0;
  for (std::size_t k = 0; k < cut.begins.size(); ++k) {
    const std::size_t end = k + 1 < cut.begins.size() ? cut.begins[k + 1] : bins.size();
    const Line line = lines.Of(cut.begins[k], end);
    double before = 0.0;
    for (std::size_t i = cut.begins[k]; i < end; ++i) {
      const double residual = std::sqrt(bins[i].weight) * (bins[i].value - line.At(bins[i].cycle));
      squares += residual * residual;
      products += before * residual;
      before = residual;
    }
  }
  constexpr double kMostCorrelated = 0.95;
  if (!(squares > 0)) return 1.0;
  const double seen = products / squares;
  const double taken = (3 * static_cast<double>(cut.begins.size()) + 1 + 3 * seen) /
                       static_cast<double>(bins.size());
  const double phi = std::clamp(seen + taken, 0.0, kMostCorrelated);
  return (1 - phi) / (1 + phi);
}

/// Two-sided, of a standard normal deviate.
double NormalPValue(double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); }

class Describer {
 public:
  Describer(std::span<const Course::Bin> bins, const ChangeThresholds& thresholds)
      : bins_(bins), thresholds_(thresholds), lines_(bins) {}

  CourseDescription Describe() {
    const std::vector<Cut> cuts = BestCuts(lines_, bins_.size());
    // What rounding leaves of the squares tells nothing.
    constexpr double kRounding = 1e-24;
    floor_ = kRounding * lines_.total_squares() + std::numeric_limits<double>::min();
    const Cut& best = cuts[NumberOfChanges(cuts)];
    CourseDescription description;
    for (std::size_t k = 0; k < best.begins.size(); ++k) {
      description.stretches.push_back(StretchOf(best, k));
    }
    for (std::size_t k = 1; k < best.begins.size(); ++k) {
      description.changes.push_back(ChangeAt(best, k));
    }
    NameKinds(description);
    return description;
  }

 private:
  /// One change more, or two, which only together may be better, as long as they are beyond chance.
  std::size_t NumberOfChanges(const std::vector<Cut>& cuts) {
    const auto bins = static_cast<double>(bins_.size());
    const double penalty = 2 * std::log(bins / thresholds_.chance);
    std::size_t changes = 0;
    effective_ = bins * ShareOfIndependent(bins_, lines_, cuts.front());
    for (std::size_t next = 1; next < cuts.size() && next <= changes + 2; ++next) {
      const double effective = bins * ShareOfIndependent(bins_, lines_, cuts[next]);
      const double ratio =
          effective * std::log((cuts[changes].squares + floor_) / (cuts[next].squares + floor_));
      if (ratio < static_cast<double>(next - changes) * penalty) continue;
      changes = next;
      effective_ = effective;
    }
    return changes;
  }

  [[nodiscard]] double LogLikelihoodScale(double squares) const {
    return effective_ * std::log(squares + floor_);
  }

  [[nodiscard]] std::size_t EndOf(const Cut& cut, std::size_t k) const {
    return k + 1 < cut.begins.size() ? cut.begins[k + 1] : bins_.size();
  }

  [[nodiscard]] Stretch StretchOf(const Cut& cut, std::size_t k) const {
    const std::size_t begin = cut.begins[k];
    const std::size_t end = EndOf(cut, k);
    const Line line = lines_.Of(begin, end);
    const Course::Bin& first = bins_[begin];
    const Course::Bin& last = bins_[end - 1];
    Stretch stretch{.first_cycle = first.first_cycle,
                    .last_cycle = last.last_cycle,
                    .at_start = line.At(first.cycle),
                    .at_end = line.At(last.cycle),
                    .slope = line.slope};
    const auto bins = static_cast<double>(bins_.size());
    const double free = bins - 2 * static_cast<double>(cut.begins.size());
    if (free > 0 && line.spread > 0) {
      const double variance = (cut.squares + floor_) / free * (bins / effective_);
      stretch.slope_p_value = NormalPValue(line.slope / std::sqrt(variance / line.spread));
    }
    const double rise = std::abs(stretch.at_end - stretch.at_start);
    stretch.trends = stretch.slope_p_value < thresholds_.chance &&
                     rise > thresholds_.trend * std::abs(line.level);
    return stretch;
  }

  [[nodiscard]] Change ChangeAt(const Cut& cut, std::size_t k) const {
    const std::size_t begin = cut.begins[k - 1];
    const std::size_t place = cut.begins[k];
    const std::size_t end = EndOf(cut, k);
    const auto squares_with = [&](std::size_t i) {
      return lines_.Of(begin, i).squares + lines_.Of(i, end).squares;
    };
    const double here = squares_with(place);
    const auto ratio = [&](double instead) {
      return LogLikelihoodScale(cut.squares - here + instead) - LogLikelihoodScale(cut.squares);
    };
    std::size_t lower = place;
    std::size_t upper = place;
    for (std::size_t i = begin + 2; i + 2 <= end; ++i) {
      if (ratio(squares_with(i)) > kChiSquared95) continue;
      lower = std::min(lower, i);
      upper = std::max(upper, i);
    }
    const double without = ratio(lines_.Of(begin, end).squares);
    const auto places = static_cast<double>(bins_.size());
    const double x = static_cast<double>(bins_[place].first_cycle);
    return {.kind = ChangeKind::kBend,
            .cycle = bins_[place].first_cycle,
            .lower95 = bins_[lower].first_cycle,
            .upper95 = bins_[upper].first_cycle,
            .before = lines_.Of(begin, place).At(x),
            .after = lines_.Of(place, end).At(x),
            .p_value = std::min(1.0, places * std::exp(-without / 2))};
  }

  void NameKinds(CourseDescription& description) const {
    std::vector<Change>& changes = description.changes;
    const std::vector<Stretch>& stretches = description.stretches;
    for (Change& change : changes) {
      if (std::abs(change.after - change.before) > thresholds_.step * std::abs(change.before)) {
        change.kind = ChangeKind::kTransition;
      }
    }
    // A running-in goes on, ever slower, until it has settled.
    for (std::size_t k = 0; k < changes.size() && stretches[k].trends; ++k) {
      const bool slows = std::abs(stretches[k + 1].slope) < std::abs(stretches[k].slope);
      if (!slows || changes[k].kind == ChangeKind::kTransition) return;
      const bool is_settled = std::abs(stretches[k + 1].slope) <=
                              thresholds_.settled * std::abs(stretches.front().slope);
      if (!is_settled && stretches[k + 1].trends) continue;
      changes[k].kind = ChangeKind::kEndOfRunningIn;
      return;
    }
  }

  std::span<const Course::Bin> bins_;
  const ChangeThresholds& thresholds_;
  Lines lines_;
  double effective_ = 0.0;
  double floor_ = 0.0;
};

}  // namespace

void Course::Add(std::size_t cycle, double value, double weight) {
  if (bins_.empty() || bins_.back().count == width_) {
    if (bins_.size() == kMostBins) {
      for (std::size_t i = 0; i < kMostBins / 2; ++i) {
        const Bin& a = bins_[2 * i];
        const Bin& b = bins_[2 * i + 1];
        bins_[i] = {.first_cycle = a.first_cycle,
                    .last_cycle = b.last_cycle,
                    .cycle = (a.cycle + b.cycle) / 2,
                    .value = (a.weight * a.value + b.weight * b.value) / (a.weight + b.weight),
                    .weight = a.weight + b.weight,
                    .least = std::min(a.least, b.least),
                    .greatest = std::max(a.greatest, b.greatest),
                    .count = a.count + b.count};
      }
      bins_.resize(kMostBins / 2);
      width_ *= 2;
    }
    bins_.push_back({.first_cycle = cycle, .last_cycle = cycle, .least = value, .greatest = value});
  }
  Bin& bin = bins_.back();
  bin.last_cycle = cycle;
  bin.least = std::min(bin.least, value);
  bin.greatest = std::max(bin.greatest, value);
  ++bin.count;
  const auto count = static_cast<double>(bin.count);
  bin.cycle += (static_cast<double>(cycle) - bin.cycle) / count;
  bin.weight += weight;
  bin.value += (value - bin.value) * weight / bin.weight;
}

std::string_view NameOf(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kEndOfRunningIn:
      return "end_of_running_in";
    case ChangeKind::kTransition:
      return "transition";
    case ChangeKind::kBend:
      return "bend";
  }
  return "";
}

CourseDescription FindChanges(const Course& course, const ChangeThresholds& thresholds) {
  if (course.bins().size() < 2) return {};
  return Describer(course.bins(), thresholds).Describe();
}

}  // namespace mindahl::campaign
