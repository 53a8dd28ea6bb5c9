#include "mindahl/loop/displacement_noise.h"

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <iterator>

#include "core/extremes.h"
#include "loop/scratch.h"
#include "loop/statistics.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {
namespace {

/// An encoder's record holds few values: most neighbours differ by whole steps or not at all. So
/// they do where a drive runs evenly, or from rest to rest; but over an encoder's steps a drive has
/// no fixed number of samples.
bool IsQuantised(std::span<const double> displacement, double step) {
  constexpr double kWhole = 1e-6;
  constexpr double kMostBroken = 0.01;  // of the pairs
  constexpr std::size_t kFewestRests = 3;
  // Multiples of a finer step are no more whole than rounding leaves them, nor any reading's.
  constexpr double kFinest = 1e-9;
  if (displacement.empty()) return false;
  const auto [lowest, highest] = ExtremesOf(displacement);
  if (!(step > kFinest * (highest - lowest))) return false;
  const auto pairs = static_cast<double>(displacement.size() - 1);
  std::size_t broken = 0;
  std::size_t rest = 1;                           // samples
  std::array<std::size_t, kFewestRests> rests{};  // different ones
  std::size_t known_rests = 0;
  bool is_even = true;
  for (std::size_t i = 1; i < displacement.size(); ++i) {
    const double steps = std::abs(displacement[i] - displacement[i - 1]) / step;
    const double nearest = std::round(steps);
    if (!(std::abs(steps - nearest) < kWhole)) {
      if (static_cast<double>(++broken) > kMostBroken * pairs) return false;
    }
    if (nearest > 1) is_even = false;
    if (steps == 0) {
      ++rest;
    } else {
      const auto end = rests.begin() + static_cast<std::ptrdiff_t>(known_rests);
      if (known_rests < kFewestRests && std::find(rests.begin(), end, rest) == end) {
        rests[known_rests++] = rest;
      }
      rest = 1;
    }
  }
  return is_even ? known_rests == kFewestRests : known_rests > 1;
}

/// The value at t = 0 of the least-squares parabola through 2h + 1 samples is their sum with the
/// weights (a − b·t²); its variance is the noise's times the middle one, a.
struct ParabolaWeights {
  explicit ParabolaWeights(std::size_t reach) {
    const auto h = static_cast<double>(reach);
    const double divisor = (2 * h - 1) * (2 * h + 1) * (2 * h + 3);
    middle = reach == 0 ? 1.0 : 3 * (3 * h * h + 3 * h - 1) / divisor;
    fall = reach == 0 ? 0.0 : 15 / divisor;
  }

  [[nodiscard]] double Apply(std::span<const double> values, std::size_t at,
                             std::size_t reach) const {
    double sum = middle * values[at];
    for (std::size_t t = 1; t <= reach; ++t) {
      const auto distance = static_cast<double>(t);
      sum += (middle - fall * distance * distance) * (values[at - t] + values[at + t]);
    }
    return sum;
  }

  double middle;
  double fall;
};

/// Windows that are tried, each about √2 times the last.
constexpr std::array<std::size_t, 15> kReaches = {2,  3,  4,  6,  8,   11,  16, 23,
                                                  32, 45, 64, 91, 128, 181, 256};

/// Returns half of the widest window about a sample in which parabolas agree.
std::size_t ReachOf(std::span<const double> values, std::size_t at, double noise) {
  constexpr double kDeviations = 2.5;
  const std::size_t room = std::min(at, values.size() - 1 - at);
  double lowest = values[at] - kDeviations * noise;
  double highest = values[at] + kDeviations * noise;
  std::size_t widest = 0;
  for (const std::size_t reach : kReaches) {
    if (reach > room) break;
    const ParabolaWeights weights(reach);
    const double estimate = weights.Apply(values, at, reach);
    const double deviation = kDeviations * noise * std::sqrt(weights.middle);
    lowest = std::max(lowest, estimate - deviation);
    highest = std::min(highest, estimate + deviation);
    if (!(lowest <= highest)) break;
    widest = reach;
  }
  return widest / 2;
}

}  // namespace

double EncoderStep(std::span<const double> displacement) {
  const double step = SmallestStep(displacement);
  return IsQuantised(displacement, step) ? step : 0.0;
}

double EstimateDisplacementNoise(std::span<const double> displacement) {
  return EstimateDisplacementNoise(displacement, std::pmr::get_default_resource());
}

double EstimateDisplacementNoise(std::span<const double> displacement,
                                 std::pmr::memory_resource* scratch) {
  constexpr double kStandardDeviationPerMedian = 1.482602218505602;  // 1/Φ⁻¹(3/4)
  std::pmr::vector<double> x(scratch);
  x.reserve(displacement.size());
  std::ranges::unique_copy(displacement, std::back_inserter(x));
  if (x.size() < 4) return 0.0;
  for (std::size_t i = x.size() - 1; i >= 3; --i) {
    x[i] = std::abs(x[i] - 3 * x[i - 1] + 3 * x[i - 2] - x[i - 3]);
  }
  const double median = boost::math::statistics::median(x.begin() + 3, x.end());
  // The variance of a third difference is (1 + 9 + 9 + 1) times the noise's.
  const double noise = kStandardDeviationPerMedian * median / std::sqrt(20.0);
  return std::max(noise, EncoderStep(displacement) / std::sqrt(12.0));
}

DisplacementSmoother::DisplacementSmoother(std::span<const double> displacement, double noise)
    : reach_(displacement.size(), 0) {
  RequireNonNegative("displacement noise [m]", noise);
  if (noise == 0) return;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    reach_[i] = ReachOf(displacement, i, noise);
  }
}

std::vector<double> DisplacementSmoother::Smooth(std::span<const double> displacement) const {
  if (displacement.size() != reach_.size()) {
    ThrowInvalid("samples to be smoothed [-]", static_cast<double>(displacement.size()),
                 "must be as many as the windows");
  }
  std::vector<double> smoothed;
  smoothed.reserve(displacement.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    smoothed.push_back(ParabolaWeights(reach_[i]).Apply(displacement, i, reach_[i]));
  }
  return smoothed;
}

std::vector<std::size_t> MoveReversals(std::span<const double> smoothed,
                                       std::span<const std::size_t> reversals) {
  std::vector<std::size_t> moved;
  for (std::size_t r = 0; r < reversals.size(); ++r) {
    // From the last turning point, which has moved, to the next, which has not.
    const std::size_t begin = moved.empty() ? 0 : moved.back();
    const std::size_t end = r + 1 < reversals.size() ? reversals[r + 1] : smoothed.size() - 1;
    const auto swing = smoothed.subspan(begin, end - begin + 1);
    const auto outermost = smoothed[reversals[r]] > smoothed[end] ? std::ranges::max_element(swing)
                                                                  : std::ranges::min_element(swing);
    const auto at = static_cast<std::size_t>(outermost - swing.begin());
    if (at > 0) moved.push_back(begin + at);  // else the record begins there
  }
  return moved;
}

}  // namespace mindahl::loop
