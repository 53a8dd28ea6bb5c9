#pragma once

#include <span>

namespace mindahl {

struct Extremes {
  double least = 0.0;
  double greatest = 0.0;
};

/// Returns the least and greatest of values that are no NaN, at least one.
[[nodiscard]] Extremes ExtremesOf(std::span<const double> values);

}  // namespace mindahl
