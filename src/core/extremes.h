#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/instruction_sets.h"

namespace mindahl {

struct Extremes {
  double least = 0.0;
  double greatest = 0.0;
};

/// Returns the least and greatest of values that are no NaN, at least one. In registers side by
/// side, as comparisons one after the other would wait for each other.
[[nodiscard]] inline Extremes ExtremesOf(std::span<const double> values) {
  using Pair = Lanes<2>;
  constexpr std::size_t kSideBySide = 4;
  const Pair first = {values[0], values[0]};
  std::array<Pair, kSideBySide> least = {first, first, first, first};
  std::array<Pair, kSideBySide> greatest = least;
  std::size_t i = 0;
  for (; i + 2 * kSideBySide <= values.size(); i += 2 * kSideBySide) {
    for (std::size_t k = 0; k < kSideBySide; ++k) {
      Pair pair;
      std::memcpy(&pair, values.data() + i + 2 * k, sizeof pair);
      least[k] = pair < least[k] ? pair : least[k];
      greatest[k] = pair > greatest[k] ? pair : greatest[k];
    }
  }
  Extremes extremes{values[0], values[0]};
  for (; i < values.size(); ++i) {
    extremes.least = std::min(extremes.least, values[i]);
    extremes.greatest = std::max(extremes.greatest, values[i]);
  }
  for (std::size_t k = 0; k < kSideBySide; ++k) {
    extremes.least = std::min({extremes.least, least[k][0], least[k][1]});
    extremes.greatest = std::max({extremes.greatest, greatest[k][0], greatest[k][1]});
  }
  return extremes;
}

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
