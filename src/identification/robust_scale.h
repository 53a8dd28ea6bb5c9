#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace mindahl::identification {

/// Standard deviation of normal values of mean 0 by the median of their magnitudes, which outliers
/// do not move.
/// @param values  at least one
inline double RobustScale(std::vector<double> values) {
  constexpr double kNormalDeviation = 1.482602218505602;  // σ over the median |r|, 1/Φ⁻¹(3/4)
  for (double& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return kNormalDeviation * *middle;
}

}  // namespace mindahl::identification
