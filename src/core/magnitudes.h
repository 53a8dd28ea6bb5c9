#pragma once

#include <bit>
#include <cstdint>
#include <span>

namespace mindahl {

/// True if all values are finite and within ±largest. Decided on integers: magnitudes are in the
/// order of their bits, and a larger one, infinity or NaN taken from the largest leaves its sign.
/// @param largest  finite, >= 0
[[nodiscard]] inline bool AreAllWithin(std::span<const double> values, double largest) {
  constexpr std::uint64_t kMagnitude = 0x7fff'ffff'ffff'ffff;
  const auto limit = std::bit_cast<std::uint64_t>(largest);
  std::uint64_t beyond = 0;
  for (const double value : values) {
    beyond |= limit - (std::bit_cast<std::uint64_t>(value) & kMagnitude);
  }
  return (beyond >> 63) == 0;
}

}  // namespace mindahl
