#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "kind.h"

/// The small run that every build makes, and what its rates may be.
namespace mindahl::reliability {

/// Loops a level of every quick kind.
inline constexpr std::size_t kSmallLoops = 4;
inline constexpr std::uint64_t kSmallSeed = 1;

/// Largest shares of the fits of a half.
struct Limit {
  Half half = Half::kDevelopment;
  double silent = 0.0;
  double warned = 0.0;
  double failed = 0.0;
  double alarms = 1.0;
  double misses = 1.0;  ///< of the intervals
};

inline constexpr std::array<Limit, 3> kLimits = {{
    {.half = Half::kDevelopment, .silent = 1.0, .warned = 1.0},
    {.half = Half::kHeldOut, .silent = 1.0, .warned = 1.0},
    {.half = Half::kClean, .silent = 0.0, .warned = 0.0, .alarms = 1.0, .misses = 1.0},
}};

}  // namespace mindahl::reliability
