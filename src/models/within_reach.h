#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>

#include "mindahl/core/error.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::models {

[[nodiscard]] inline bool IsWithinReach(double displacement) {
  return std::abs(displacement) <= kLargestPathDisplacement;
}

/// All of them. Vectors of integers tell it: magnitudes are in the order of their bits, and a
/// larger one, infinity or NaN taken from the largest leaves its sign.
[[nodiscard]] inline bool AreWithinReach(std::span<const double> displacement) {
  constexpr std::uint64_t kMagnitude = 0x7fff'ffff'ffff'ffff;
  constexpr auto kLargest = std::bit_cast<std::uint64_t>(kLargestPathDisplacement);
  std::uint64_t beyond = 0;
  for (const double x : displacement) {
    beyond |= kLargest - (std::bit_cast<std::uint64_t>(x) & kMagnitude);
  }
  return (beyond >> 63) == 0;
}

/// @throws InvalidArgument unless the displacement can be part of a path
inline void RequireWithinReach(std::string_view quantity, double displacement) {
  if (!IsWithinReach(displacement)) {
    ThrowInvalid(quantity, displacement, "must be finite and within +-1e307 m");
  }
}

}  // namespace mindahl::models
