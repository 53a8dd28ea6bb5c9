#include "mindahl/loop/reversals.h"

#include <algorithm>
#include <cmath>

#include "loop/scratch.h"
#include "loop/smallest_step.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/displacement_noise.h"

namespace mindahl::loop {
namespace {

/// A closed inner loop of the displacement history.
struct InnerLoop {
  double range;          // [m]
  std::size_t duration;  // [samples] between its two extremes
};

/// Four-point rainflow count: the middle two of four successive extremes form a closed inner loop
/// when their range does not exceed either neighbour's (ASTM E1049 describes the equivalent rule).
std::pmr::vector<InnerLoop> ClosedInnerLoops(std::span<const double> displacement,
                                             std::span<const std::size_t> extremes,
                                             std::pmr::memory_resource* scratch) {
  std::pmr::vector<InnerLoop> loops(scratch);
  std::pmr::vector<std::size_t> open(scratch);
  loops.reserve(extremes.size() / 2 + 1);
  open.reserve(extremes.size());
  const auto range = [&](std::size_t i, std::size_t j) {
    return std::abs(displacement[open[i]] - displacement[open[j]]);
  };
  for (const std::size_t extreme : extremes) {
    open.push_back(extreme);
    while (open.size() >= 4) {
      const std::size_t last = open.size() - 1;
      const double inner = range(last - 2, last - 1);
      if (inner > range(last - 3, last - 2) || inner > range(last - 1, last)) break;
      loops.push_back({inner, open[last - 1] - open[last - 2]});
      open.erase(open.end() - 3, open.end() - 1);
    }
  }
  return loops;
}

}  // namespace

std::vector<std::size_t> FindReversals(std::span<const double> displacement, double gate) {
  std::pmr::vector<std::size_t> reversals;
  FindReversals(displacement, gate, reversals);
  return {reversals.begin(), reversals.end()};
}

void FindReversals(std::span<const double> displacement, double gate,
                   std::pmr::vector<std::size_t>& reversals) {
  RequireNonNegative("reversal gate [m]", gate);
  reversals.clear();
  if (displacement.empty()) return;

  std::size_t highest = 0;
  std::size_t lowest = 0;
  int direction = 0;  // unknown until the displacement has left the gate
  for (std::size_t i = 1; i < displacement.size(); ++i) {
    if (direction >= 0 && displacement[i] > displacement[highest]) highest = i;
    if (direction <= 0 && displacement[i] < displacement[lowest]) lowest = i;
    if (direction >= 0 && displacement[highest] - displacement[i] > gate) {
      if (direction > 0) reversals.push_back(highest);
      direction = -1;
      lowest = i;
    } else if (direction <= 0 && displacement[i] - displacement[lowest] > gate) {
      if (direction < 0) reversals.push_back(lowest);
      direction = 1;
      highest = i;
    }
  }
}

double EstimateReversalGate(std::span<const double> displacement) {
  return EstimateReversalGate(displacement, std::pmr::get_default_resource());
}

double EstimateReversalGate(std::span<const double> displacement,
                            std::pmr::memory_resource* scratch) {
  constexpr std::size_t kShort = 3;    // [samples] a drive takes longer to turn twice
  constexpr double kRough = 0.05;      // more "noise" than this share of the range is the drive
  constexpr double kSteps = 2.5;       // two of an encoder, and rounding
  constexpr double kClearGap = 3.0;    // ratio across the gap when many loops lie below it
  constexpr double kLastGap = 5.0;     // likewise, when no closed loop lies above it
  constexpr std::size_t kMany = 8;     // by chance: (1/kClearGap)^kMany = 1.5e-4
  constexpr double kWideGap = 10.0;    // ratio across the gap when few do,
  constexpr double kLargeShare = 0.1;  // and the drive's loops are this share of the range

  std::pmr::vector<std::size_t> extremes(scratch);
  FindReversals(displacement, 0.0, extremes);
  if (extremes.size() < 4) return 0.0;
  const auto [lowest, highest] = std::ranges::minmax(displacement);
  const double full_range = highest - lowest;
  const double noise = EstimateDisplacementNoise(displacement, scratch);
  if (noise > kRough * full_range) return 0.0;
  // Normal noise of n samples reaches √(2 ln n) standard deviations to either side.
  const double reach = std::sqrt(2 * std::log(static_cast<double>(displacement.size())));
  const double noise_range = std::max(2 * reach * noise, kSteps * SmallestStep(displacement));

  // The record's ends close loops too: without them a half cycle of noise stays open.
  std::pmr::vector<std::size_t> turning_points(scratch);
  turning_points.reserve(extremes.size() + 2);
  turning_points.push_back(0);
  turning_points.insert(turning_points.end(), extremes.begin(), extremes.end());
  turning_points.push_back(displacement.size() - 1);
  std::pmr::vector<InnerLoop> loops = ClosedInnerLoops(displacement, turning_points, scratch);
  std::ranges::sort(loops, {}, &InnerLoop::range);

  double gate = 0.0;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (loops[i].duration > kShort && loops[i].range > noise_range) break;
    const bool last = i + 1 == loops.size();
    const double next = last ? full_range : loops[i + 1].range;
    const double ratio = next / loops[i].range;
    const bool many_below = i + 1 >= kMany && ratio >= (last ? kLastGap : kClearGap);
    const bool far_below = ratio >= kWideGap && next >= kLargeShare * full_range;
    if (many_below || far_below) {
      gate = std::min(2 * loops[i].range, std::sqrt(loops[i].range * next));
    }
  }
  return gate;
}

}  // namespace mindahl::loop
