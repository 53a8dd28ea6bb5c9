#pragma once

#include <algorithm>
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
auto MedianOf(Values&& values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace mindahl::loop
