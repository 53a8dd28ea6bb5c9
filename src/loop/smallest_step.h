#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace mindahl::loop {

/// Returns the least distance [m] between neighbours that differ; 0 where none do.
inline double SmallestStep(std::span<const double> displacement) {
  // Magnitudes are in the order of their bits, and of one less those of no step come last.
  constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t smallest = kNone;
  for (std::size_t i = 1; i < displacement.size(); ++i) {
    const double step = std::abs(displacement[i] - displacement[i - 1]);
    smallest = std::min(smallest, std::bit_cast<std::uint64_t>(step) - 1);
  }
  return smallest == kNone ? 0.0 : std::bit_cast<double>(smallest + 1);
}

}  // namespace mindahl::loop
