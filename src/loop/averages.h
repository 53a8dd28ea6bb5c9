#pragma once

#include <algorithm>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <iterator>
#include <numeric>
#include <span>

namespace mindahl::loop {

/// Of values, at least one.
inline double Mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The middle one of values, at least one; of an even number the upper of the two. Reorders them.
template <typename Values>
auto UpperMedian(Values&& values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The middle one of values, at least one; of an even number the mean of the two. Reorders them.
template <typename Values>
double Median(Values&& values) {
  return boost::math::statistics::median(values.begin(), values.end());
}

}  // namespace mindahl::loop
