#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "mindahl/campaign/evolution.h"

namespace mindahl::campaign {

namespace {

constexpr std::size_t kMostChanges = 8;
constexpr std::size_t kFewChanges = 4;  // without one of which there are none
constexpr std::size_t kLeastBins = 4;   // of a segment: two beyond a line
constexpr std::size_t kLeastSettling = 2 * kLeastBins;
constexpr double kTimeConstantStep = 1.2;  // from one that is tried to the next
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

/// Fits a time history that settles: y = level + fall·e, e = exp(−(x − x₁)/τ), x₁ the first bin's.
struct Settling {
  double x1 = 0.0;
  double level = 0.0;
  double fall = 0.0;
  double time_constant = 0.0;  // τ, cycles
  double squares = 0.0;        // Σw(y − curve)²

  [[nodiscard]] double At(double x) const {
    return level + fall * std::exp(-(x - x1) / time_constant);
  }
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

/// Least-squares curves of one τ through the first bins, however many, from sums up to each.
class SettlingCurves {
 public:
  SettlingCurves(std::span<const Course::Bin> bins, double time_constant)
      : x1_(bins.front().cycle), time_constant_(time_constant), sums_(bins.size() + 1) {
    double total = 0.0;
    for (const Course::Bin& bin : bins) {
      total += bin.weight;
      y_centre_ += bin.value / static_cast<double>(bins.size());
    }
    const double mean_weight = total / static_cast<double>(bins.size());
    for (std::size_t i = 0; i < bins.size(); ++i) {
      const long double w = bins[i].weight / mean_weight;
      const long double e = std::exp(-(bins[i].cycle - x1_) / time_constant);
      const long double y = bins[i].value - y_centre_;
      const Sums& s = sums_[i];
      sums_[i + 1] = {s.w + w,          s.e + w * e,      s.y + w * y,
                      s.ee + w * e * e, s.ey + w * e * y, s.yy + w * y * y};
    }
  }

  [[nodiscard]] double time_constant() const { return time_constant_; }

  [[nodiscard]] Settling Of(std::size_t end) const {
    const Sums& s = sums_[end];
    const long double e = s.e / s.w;
    const long double y = s.y / s.w;
    const long double ee = s.ee - s.w * e * e;
    const long double ey = s.ey - s.w * e * y;
    const long double yy = s.yy - s.w * y * y;
    const long double fall = ee > 0 ? ey / ee : 0;
    return {.x1 = x1_,
            .level = static_cast<double>(y - fall * e) + y_centre_,
            .fall = static_cast<double>(fall),
            .time_constant = time_constant_,
            .squares = std::max(0.0, static_cast<double>(yy - fall * ey))};
  }

 private:
  struct Sums {
    long double w, e, y, ee, ey, yy;
  };
  double x1_;
  double time_constant_;
  double y_centre_ = 0.0;
  std::vector<Sums> sums_;
};

/// Returns time constants, from that of a single bin to the whole history, in steps of a fifth.
std::vector<SettlingCurves> CurvesThrough(std::span<const Course::Bin> bins) {
  std::vector<SettlingCurves> curves;
  const double longest = bins.back().cycle - bins.front().cycle;
  for (double tau = bins[1].cycle - bins[0].cycle; tau <= longest; tau *= kTimeConstantStep) {
    curves.emplace_back(bins, tau);
  }
  return curves;
}

/// Holds a division into segments: the bins of each, and the squares that are left. The bin within
/// which something changes is of neither side, and may be left out between two.
struct Cut {
  struct Part {
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  std::vector<Part> parts;
  double squares = 0.0;
  std::optional<Settling> settling = std::nullopt;  ///< in place of the first part's line
};

/// The best cut for every number of what it is made of: places, bins left out, a curve, each of
/// which counts for one.
class BestCuts {
 public:
  /// @param of_curve  squares of a curve through the first bins, up to before each
  /// @param changes   what a cut is made of at the most
  BestCuts(const Lines& lines, std::size_t bins, std::span<const double> of_curve,
           std::size_t changes)
      : most_(std::clamp<std::size_t>(bins / (2 * kLeastBins), 1, changes + 1)), best_(bins + 1) {
    for (std::size_t j = 1; j <= bins; ++j) {
      Best& best = best_[j];
      best.squares[0] = lines.Of(0, j).squares;
      best.squares[1] = most_ > 1 ? of_curve[j] : kNone;
      // The line over [i, j) is the last part of cuts that are made of any number.
      for (std::size_t i = kLeastBins; i + kLeastBins <= j; ++i) {
        const double of_line = lines.Of(i, j).squares;
        Improve<0>(best, i, of_line);
        if (i > kLeastBins) Improve<1>(best, i, of_line);
      }
    }
  }

  [[nodiscard]] std::vector<Cut> All() const {
    std::vector<Cut> cuts;
    for (std::size_t k = 0; k < most_ && best_.back().squares[k] < kNone; ++k) {
      cuts.push_back(MadeOf(k));
    }
    return cuts;
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  /// Up to before a bin, by what it is made of.
  struct Best {
    Best() { squares.fill(kNone); }
    std::array<double, kMostChanges + 1> squares;
    std::array<std::size_t, kMostChanges + 1> begin{};  // of the last part; 0: it is the first
    std::array<std::size_t, kMostChanges + 1> left_out{};
  };

  template <std::size_t kLeftOut>
  void Improve(Best& best, std::size_t i, double of_line) const {
    const std::array<double, kMostChanges + 1>& before = best_[i - kLeftOut].squares;
    constexpr std::size_t kMadeOf = 1 + kLeftOut;
    for (std::size_t k = kMadeOf; k < most_; ++k) {
      const double squares = before[k - kMadeOf] + of_line;
      if (!(squares < best.squares[k])) continue;
      best.squares[k] = squares;
      best.begin[k] = i;
      best.left_out[k] = kLeftOut;
    }
  }

  [[nodiscard]] Cut MadeOf(std::size_t number) const {
    Cut cut{.parts = {}, .squares = best_.back().squares[number]};
    std::size_t end = best_.size() - 1;
    for (;;) {
      const Best& best = best_[end];
      cut.parts.insert(cut.parts.begin(), {best.begin[number], end});
      if (best.begin[number] == 0) break;
      end = best.begin[number] - best.left_out[number];
      number -= 1 + best.left_out[number];
    }
    if (number > 0) cut.settling.emplace();  // whichever it is
    return cut;
  }

  std::size_t most_;
  std::vector<Best> best_;
};

/// The line, or the curve, of a part of a cut.
class PieceOf {
 public:
  PieceOf(const Lines& lines, const Cut& cut, std::size_t k)
      : line_(lines.Of(cut.parts[k].begin, cut.parts[k].end)),
        settling_(k == 0 ? cut.settling : std::nullopt) {}

  [[nodiscard]] double At(double x) const { return settling_ ? settling_->At(x) : line_.At(x); }

 private:
  Line line_;
  std::optional<Settling> settling_;
};

/// Weighted residuals √w·(y − piece) of all bins of a cut, one part after the other.
std::vector<double> ResidualsOf(std::span<const Course::Bin> bins, const Lines& lines,
                                const Cut& cut) {
  std::vector<double> residuals;
  residuals.reserve(bins.size());
  for (std::size_t k = 0; k < cut.parts.size(); ++k) {
    const PieceOf piece(lines, cut, k);
    for (std::size_t i = cut.parts[k].begin; i < cut.parts[k].end; ++i) {
      residuals.push_back(std::sqrt(bins[i].weight) * (bins[i].value - piece.At(bins[i].cycle)));
    }
  }
  return residuals;
}

/// Returns by how much correlation of neighbours inflates the variance of means, (1 + φ)/(1 − φ), φ
/// the residuals' lag-one correlation. Lines take of it about as many nths as they have parameters
/// and places, three a part, the estimate itself 1 + 3φ (Marriott & Pope 1954); and it is taken
/// a standard error, 1/√n, larger than it was seen.
double InflationOfNeighbours(std::span<const double> residuals, const Cut& cut, double bins) {
  double squares = 0.0;
  double products = 0.0;
  auto residual = residuals.begin();
  for (const Cut::Part& part : cut.parts) {
    double before = 0.0;
    for (std::size_t i = part.begin; i < part.end; ++i, ++residual) {
      squares += *residual * *residual;
      products += before * *residual;
      before = *residual;
    }
  }
  constexpr double kMostCorrelated = 0.95;
  constexpr double kStandardErrors = 1.0;
  if (!(squares > 0)) return 1.0;
  const double seen = products / squares;
  const double taken = (3 * static_cast<double>(cut.parts.size()) + 1 + 3 * seen) / bins;
  const double phi =
      std::clamp(seen + taken + kStandardErrors / std::sqrt(bins), 0.0, kMostCorrelated);
  return (1 + phi) / (1 - phi);
}

/// Returns the largest inflation of the variance of the means of 2, 4, 8, … bins over that of
/// uncorrelated ones: correlation over many bins, too weak to be seen between neighbours, is seen
/// there. Lines and their places take three blocks of each part, kTaken; where fewer than that are
/// left in all, a variance is not known to better than a factor of two.
double InflationOfBlocks(std::span<const double> residuals, const Cut& cut) {
  constexpr std::size_t kTaken = 3;
  double squares = 0.0;
  for (const double residual : residuals) squares += residual * residual;
  const auto count = static_cast<double>(residuals.size());
  const double free = count - static_cast<double>(kTaken * cut.parts.size());
  double largest = 1.0;
  if (!(squares > 0) || !(free > 0)) return largest;
  for (std::size_t size = 2;; size *= 2) {
    double of_blocks = 0.0;
    std::size_t free_blocks = 0;
    auto residual = residuals.begin();
    for (const Cut::Part& part : cut.parts) {
      const std::size_t length = part.end - part.begin;
      const std::size_t blocks = length / size;
      if (blocks > kTaken) {
        free_blocks += blocks - kTaken;
        for (std::size_t k = 0; k < blocks; ++k) {
          const auto begin = residual + static_cast<std::ptrdiff_t>(k * size);
          const double sum = std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(size), 0.0);
          of_blocks += sum * sum / static_cast<double>(size);
        }
      }
      residual += static_cast<std::ptrdiff_t>(length);
    }
    if (free_blocks < kTaken) return largest;
    largest = std::max(largest, of_blocks / static_cast<double>(free_blocks) / (squares / free));
  }
}

/// Returns what fraction of n bins are as good as independent.
double ShareOfIndependent(std::span<const Course::Bin> bins, const Lines& lines, const Cut& cut) {
  const std::vector<double> residuals = ResidualsOf(bins, lines, cut);
  return 1 / std::max(InflationOfNeighbours(residuals, cut, static_cast<double>(bins.size())),
                      InflationOfBlocks(residuals, cut));
}

/// Two-sided, of a standard normal deviate.
double NormalPValue(double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); }

class Describer {
 public:
  Describer(std::span<const Course::Bin> bins, const ChangeThresholds& thresholds)
      : bins_(bins), thresholds_(thresholds), lines_(bins), curves_(CurvesThrough(bins)) {}

  CourseDescription Describe() {
    // The rounding of the squares is no information.
    constexpr double kRounding = 1e-24;
    floor_ = kRounding * lines_.total_squares() + std::numeric_limits<double>::min();
    Cut best = BestCut(kFewChanges);
    if (best.parts.size() > 1 || best.settling) {
      // The time constant that was found lies between those that were tried.
      if (best.settling) curves_.emplace_back(bins_, best.settling->time_constant);
      best = BestCut(kMostChanges);
    }
    CourseDescription description;
    for (std::size_t k = 0; k < best.parts.size(); ++k) {
      description.stretches.push_back(StretchOf(best, k));
    }
    for (std::size_t k = 1; k < best.parts.size(); ++k) {
      description.changes.push_back(ChangeAt(best, k));
    }
    NameKinds(description);
    if (best.settling) DivideWhereItHasSettled(best, *best.settling, description);
    return description;
  }

 private:
  /// The least squares of a curve through the first bins, of the time constants that are tried.
  [[nodiscard]] double SquaresOfCurve(std::size_t end) const {
    double least = std::numeric_limits<double>::infinity();
    for (const SettlingCurves& curves : curves_) least = std::min(least, curves.Of(end).squares);
    return least;
  }

  [[nodiscard]] Settling BestCurve(std::size_t end) const {
    const auto nearest = std::ranges::min_element(
        curves_, {}, [end](const SettlingCurves& curves) { return curves.Of(end).squares; });
    const double centre = std::log(nearest->time_constant());
    constexpr int kBits = 20;  // half the digits: a minimum is no better known
    const auto squares_at = [&](double log_tau) {
      return SettlingCurves(bins_.first(end), std::exp(log_tau)).Of(end).squares;
    };
    const double step = std::log(kTimeConstantStep);
    const double log_tau =
        boost::math::tools::brent_find_minima(squares_at, centre - step, centre + step, kBits)
            .first;
    return SettlingCurves(bins_, std::exp(log_tau)).Of(end);
  }

  /// The best cut of as many changes as are beyond chance, up to a number.
  Cut BestCut(std::size_t most) {
    std::vector<double> of_curve(bins_.size() + 1, std::numeric_limits<double>::infinity());
    for (std::size_t j = kLeastSettling; j <= bins_.size(); ++j) of_curve[j] = SquaresOfCurve(j);
    std::vector<Cut> cuts = BestCuts(lines_, bins_.size(), of_curve, most).All();
    for (Cut& cut : cuts) {
      if (!cut.settling) continue;
      const std::size_t end = cut.parts.front().end;
      cut.settling = BestCurve(end);
      cut.squares += cut.settling->squares - of_curve[end];
    }
    return cuts[NumberOfChanges(cuts)];
  }

  /// Any number of changes more, as long as they are beyond chance: of a time history that bends,
  /// two may be worth nothing where three are worth much.
  std::size_t NumberOfChanges(const std::vector<Cut>& cuts) {
    const auto bins = static_cast<double>(bins_.size());
    const double penalty = 2 * std::log(bins / thresholds_.chance);
    std::size_t changes = 0;
    effective_ = bins * ShareOfIndependent(bins_, lines_, cuts.front());
    for (std::size_t next = 1; next < cuts.size(); ++next) {
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

  /// Within what single values of the bins have been: the ends of a line through what is not
  /// straight may lie beyond.
  [[nodiscard]] double Within(std::size_t begin, std::size_t end, double value) const {
    const auto bins = bins_.subspan(begin, end - begin);
    return std::clamp(value, std::ranges::min(bins, {}, &Course::Bin::least).least,
                      std::ranges::max(bins, {}, &Course::Bin::greatest).greatest);
  }

  /// Bins in a row, with what runs through them.
  template <typename Piece>
  [[nodiscard]] Stretch StretchOver(std::size_t begin, std::size_t end, const Piece& piece,
                                    const Cut& cut) const {
    const Line line = lines_.Of(begin, end);
    const Course::Bin& first = bins_[begin];
    const Course::Bin& last = bins_[end - 1];
    Stretch stretch{.first_cycle = first.first_cycle,
                    .last_cycle = last.last_cycle,
                    .at_start = Within(begin, end, piece.At(first.cycle)),
                    .at_end = Within(begin, end, piece.At(last.cycle)),
                    .slope = line.slope};
    const auto bins = static_cast<double>(bins_.size());
    const double free = bins - 2 * static_cast<double>(cut.parts.size());
    if (free > 0 && line.spread > 0) {
      const double variance = (cut.squares + floor_) / free * (bins / effective_);
      stretch.slope_p_value = NormalPValue(line.slope / std::sqrt(variance / line.spread));
    }
    const double rise = std::abs(stretch.at_end - stretch.at_start);
    stretch.trends = stretch.slope_p_value < thresholds_.chance &&
                     rise > thresholds_.trend * std::abs(line.level);
    return stretch;
  }

  [[nodiscard]] Stretch StretchOf(const Cut& cut, std::size_t k) const {
    const Cut::Part& part = cut.parts[k];
    Stretch stretch = StretchOver(part.begin, part.end, PieceOf(lines_, cut, k), cut);
    if (k == 0 && cut.settling) stretch.time_constant = cut.settling->time_constant;
    return stretch;
  }

  [[nodiscard]] Change ChangeAt(const Cut& cut, std::size_t k) const {
    const std::size_t begin = cut.parts[k - 1].begin;
    const std::size_t before = cut.parts[k - 1].end;
    const std::size_t after = cut.parts[k].begin;
    const std::size_t end = cut.parts[k].end;
    const std::size_t left_out = after - before;
    const bool settles = k == 1 && cut.settling;
    std::optional<SettlingCurves> curves;
    if (settles) curves.emplace(bins_, cut.settling->time_constant);
    const auto squares_before = [&](std::size_t i) {
      return settles ? curves->Of(i).squares : lines_.Of(begin, i).squares;
    };
    const auto squares_with = [&](std::size_t i) {
      return squares_before(i) + lines_.Of(i + left_out, end).squares;
    };
    const double here = squares_with(before);
    const auto ratio = [&](double instead) {
      return LogLikelihoodScale(cut.squares - here + instead) - LogLikelihoodScale(cut.squares);
    };
    std::size_t lower = before;
    std::size_t upper = before;
    for (std::size_t i = begin + 2; i + left_out + 2 <= end; ++i) {
      if (ratio(squares_with(i)) > kChiSquared95) continue;
      lower = std::min(lower, i);
      upper = std::max(upper, i);
    }
    const double without =
        ratio(settles ? std::min(squares_before(end), SquaresOfCurve(end)) : squares_before(end));
    const auto places = static_cast<double>(bins_.size());
    const double x = static_cast<double>(bins_[after].first_cycle);
    Change change{
        .cycle = bins_[after].first_cycle,
        // Within a bin of several cycles, on either side where none is left out.
        .lower95 = left_out > 0 ? bins_[lower].first_cycle : bins_[lower - 1].first_cycle + 1,
        .upper95 = left_out > 0 ? bins_[upper].last_cycle + 1 : bins_[upper].last_cycle,
        .before = Within(begin, before, PieceOf(lines_, cut, k - 1).At(x)),
        .after = Within(after, end, lines_.Of(after, end).At(x)),
        .p_value = std::min(1.0, places * std::exp(-without / 2))};
    if (left_out > 0) change.cycle = FirstAfter(bins_[before], change);
    return change;
  }

  /// Returns the first cycle after a step within a bin: the bin's mean determines it.
  static std::size_t FirstAfter(const Course::Bin& bin, const Change& change) {
    const double step = change.after - change.before;
    const double share = step == 0 ? 0.0 : std::clamp((bin.value - change.before) / step, 0.0, 1.0);
    const double cycles = static_cast<double>(bin.last_cycle - bin.first_cycle + 1);
    return bin.last_cycle + 1 - static_cast<std::size_t>(std::lround(share * cycles));
  }

  /// The first cycle at which the rate of a curve has fallen to what counts as settled.
  [[nodiscard]] double SettledCycle(double time_constant) const {
    return static_cast<double>(bins_.front().first_cycle) -
           time_constant * std::log(thresholds_.settled);
  }

  /// Divides the first segment where its curve has settled before its end: that is a change.
  void DivideWhereItHasSettled(const Cut& cut, const Settling& curve,
                               CourseDescription& description) const {
    const std::size_t end = cut.parts.front().end;
    const double last = static_cast<double>(bins_[end - 1].last_cycle);
    const double settled_at = SettledCycle(curve.time_constant);
    const auto place = static_cast<std::size_t>(
        std::ranges::find_if(bins_,
                             [&](const Course::Bin& bin) {
                               return static_cast<double>(bin.first_cycle) >= settled_at;
                             }) -
        bins_.begin());
    if (place >= end) return;
    const double others = cut.squares - curve.squares;
    const auto ratio = [&](double instead) {
      return LogLikelihoodScale(others + instead) - LogLikelihoodScale(cut.squares);
    };
    double lower = settled_at;
    double upper = settled_at;
    constexpr double kLeastStep = 0.003;  // of ln τ
    constexpr double kGrowth = 1.1;
    constexpr double kFarthest = 3.0;
    for (const int sense : {-1, 1}) {
      for (double step = kLeastStep; step < kFarthest; step *= kGrowth) {
        const double tau = curve.time_constant * std::exp(sense * step);
        if (ratio(SettlingCurves(bins_, tau).Of(end).squares) > kChiSquared95) break;
        lower = std::min(lower, SettledCycle(tau));
        upper = std::clamp(SettledCycle(tau), upper, last);
      }
    }
    const auto places = static_cast<double>(bins_.size());
    const double without = ratio(lines_.Of(0, end).squares);
    const double value = Within(0, end, curve.At(settled_at));
    description.changes.insert(description.changes.begin(),
                               {.kind = ChangeKind::kEndOfRunningIn,
                                .cycle = static_cast<std::size_t>(std::ceil(settled_at)),
                                .lower95 = static_cast<std::size_t>(std::floor(lower)),
                                .upper95 = static_cast<std::size_t>(std::ceil(upper)),
                                .before = value,
                                .after = value,
                                .p_value = std::min(1.0, places * std::exp(-without / 2))});
    Stretch running_in = StretchOver(0, place, curve, cut);
    Stretch settled = StretchOver(place, end, curve, cut);
    running_in.time_constant = settled.time_constant = curve.time_constant;
    description.stretches.front() = settled;
    description.stretches.insert(description.stretches.begin(), running_in);
  }

  void NameKinds(CourseDescription& description) const {
    std::vector<Change>& changes = description.changes;
    const std::vector<Stretch>& stretches = description.stretches;
    for (Change& change : changes) {
      if (std::abs(change.after - change.before) > thresholds_.step * std::abs(change.before)) {
        change.kind = ChangeKind::kTransition;
      }
    }
    if (stretches.front().time_constant) return;  // its curve describes it
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
  std::vector<SettlingCurves> curves_;
  double effective_ = 0.0;
  double floor_ = 0.0;
};

/// Divides values by a power of two, so that the largest is about one and no square overflows, and
/// weights by the largest; those below a trillionth of it are lost in rounding and are raised to
/// it.
/// @returns the power of two
double Normalise(std::vector<Course::Bin>& bins) {
  constexpr double kLeastWeight = 1e-12;
  double largest = 0.0;
  double heaviest = 0.0;
  for (const Course::Bin& bin : bins) {
    largest = std::max({largest, std::abs(bin.least), std::abs(bin.greatest)});
    heaviest = std::max(heaviest, bin.weight);
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  --exponent;  // of the greatest double it is no double's exponent
  for (Course::Bin& bin : bins) {
    for (double* const value : {&bin.value, &bin.least, &bin.greatest}) {
      *value = std::ldexp(*value, -exponent);
    }
    bin.weight = std::max(bin.weight / heaviest, kLeastWeight);
  }
  return std::ldexp(1.0, exponent);
}

/// Pulls single bins that lie far from the median of their neighbours to the edge of what others
/// do: a change lasts for kLeastBins. Medians of seven leave steps and slopes as they are.
void PullInOutliers(std::vector<Course::Bin>& bins) {
  constexpr std::size_t kReach = kLeastBins - 1;
  constexpr double kFarthest = 4.5;       // standard deviations
  constexpr double kUsual = 0.9;          // of the bins are no outliers
  constexpr double kDeviations = 1.6449;  // within which so many of a normal law are
  std::vector<double> medians(bins.size());
  std::vector<double> far(bins.size());
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const std::size_t reach = std::min({kReach, i, bins.size() - 1 - i});
    std::array<double, 2 * kReach + 1> near{};
    for (std::size_t k = 0; k <= 2 * reach; ++k) near[k] = bins[i - reach + k].value;
    const auto middle = near.begin() + static_cast<std::ptrdiff_t>(reach);
    std::nth_element(near.begin(), middle, middle + static_cast<std::ptrdiff_t>(reach + 1));
    medians[i] = *middle;
    far[i] = std::sqrt(bins[i].weight) * std::abs(bins[i].value - medians[i]);
  }
  std::vector<double> sorted = far;
  const auto usual =
      sorted.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(sorted.size() - 1));
  std::ranges::nth_element(sorted, usual);
  const double farthest = kFarthest / kDeviations * *usual;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (!(far[i] > farthest)) continue;
    const double reach = farthest / std::sqrt(bins[i].weight);
    bins[i].value = std::clamp(bins[i].value, medians[i] - reach, medians[i] + reach);
    bins[i].least = std::clamp(bins[i].least, medians[i] - reach, bins[i].value);
    bins[i].greatest = std::clamp(bins[i].greatest, bins[i].value, medians[i] + reach);
  }
}

}  // namespace

/// The curve that has the values at the ends and the time constant between them.
double Stretch::At(double cycle) const {
  const double way = static_cast<double>(last_cycle) - static_cast<double>(first_cycle);
  if (!(way > 0)) return at_start;
  const double on = cycle - static_cast<double>(first_cycle);
  const double share = time_constant
                           ? std::expm1(-on / *time_constant) / std::expm1(-way / *time_constant)
                           : on / way;
  return at_start + share * (at_end - at_start);
}

void Course::Add(std::size_t cycle, double value, double weight) {
  if (bins_.empty() || bins_.back().count == width_) {
    if (bins_.size() == kMostBins) {
      for (std::size_t i = 0; i < kMostBins / 2; ++i) {
        const Bin& a = bins_[2 * i];
        const Bin& b = bins_[2 * i + 1];
        bins_[i] = {.first_cycle = a.first_cycle,
                    .last_cycle = b.last_cycle,
                    .cycle = (a.cycle + b.cycle) / 2,
                    .value = a.value * (a.weight / (a.weight + b.weight)) +
                             b.value * (b.weight / (a.weight + b.weight)),
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
  const double share = weight / bin.weight;
  bin.value = bin.value * (1 - share) + value * share;
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
  std::vector<Course::Bin> bins(course.bins().begin(), course.bins().end());
  double unit = Normalise(bins);
  PullInOutliers(bins);
  unit *= Normalise(bins);
  CourseDescription description = Describer(bins, thresholds).Describe();
  for (Stretch& stretch : description.stretches) {
    stretch.at_start *= unit;
    stretch.at_end *= unit;
    stretch.slope = std::clamp(stretch.slope * unit, std::numeric_limits<double>::lowest(),
                               std::numeric_limits<double>::max());
  }
  for (Change& change : description.changes) {
    change.before *= unit;
    change.after *= unit;
  }
  return description;
}

}  // namespace mindahl::campaign
