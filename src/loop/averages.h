#pragma once

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cstddef>
#include <iterator>
#include <span>

namespace mindahl::loop {

/// Returns the mean of at least one value, in four parallel sums that do not wait for each other.
inline double Mean(std::span<const double> values) {
  constexpr std::size_t kSideBySide = 4;
  std::array<double, kSideBySide> sums{};
  std::size_t i = 0;
  for (; i + kSideBySide <= values.size(); i += kSideBySide) {
    for (std::size_t k = 0; k < kSideBySide; ++k) sums[k] += values[i + k];
  }
  for (std::size_t k = 0; i < values.size(); ++i, ++k) sums[k] += values[i];
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) / static_cast<double>(values.size());
}

/// Returns the middle of at least one value; of an even number the upper of two. Reorders them.
template <typename Values>
auto UpperMedian(Values&& values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Returns the middle of at least one value; of an even number the mean of the two. Reorders them.
template <typename Values>
double Median(Values&& values) {
  return boost::math::statistics::median(values.begin(), values.end());
}

}  // namespace mindahl::loop
