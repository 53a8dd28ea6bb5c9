#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace mindahl::loop {

/// Least distance [m] between neighbours that differ; 0 where none do.
inline double SmallestStep(std::span<const double> displacement) {
  double smallest = 0.0;
  for (std::size_t i = 1; i < displacement.size(); ++i) {
    const double step = std::abs(displacement[i] - displacement[i - 1]);
    if (step > 0 && (smallest == 0 || step < smallest)) smallest = step;
  }
  return smallest;
}

}  // namespace mindahl::loop
