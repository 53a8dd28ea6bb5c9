#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kind.h"

/// The small run that every build makes, and what its rates may be.
namespace mindahl::reliability {

/// Loops a level of every quick kind.
inline constexpr std::size_t kSmallLoops = 3;
inline constexpr std::uint64_t kSmallSeed = 1;

/// Shares of the fits of a half, and of the intervals those that miss.
struct Rates {
  Half half = Half::kDevelopment;
  double silent = 0.0;
  double warned = 0.0;
  double failed = 0.0;
  double false_limits = 0.0;
  double alarms = 0.0;
  double misses = 0.0;
};

/// Those of the quick kinds over fifty loops a level, seed 1: what docs/reliability.md has. To be
/// lowered with every change that lowers them. Alarms and misses are bounded on clean loops alone;
/// on others an alarm is as it should be.
inline constexpr std::array<Rates, 3> kMeasured = {{
    {Half::kDevelopment, 0.004, 0.017, 0.0, 0.001, 1.0, 1.0},
    {Half::kHeldOut, 0.009, 0.010, 0.0, 0.001, 1.0, 1.0},
    {Half::kClean, 0.0, 0.0, 0.0, 0.001, 0.028, 0.043},
}};

/// Two standard deviations of the counting above the rate: a rate that is right exceeds it once in
/// forty runs with other loops, and never with the same ones; one that has doubled does, where more
/// than four are to be counted.
/// @param count  fits, or intervals
inline double LimitOf(double rate, std::size_t count) {
  return rate + 2 * std::sqrt(rate * (1 - rate) / static_cast<double>(count));
}

}  // namespace mindahl::reliability
