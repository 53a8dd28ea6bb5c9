#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>

namespace mindahl {

struct Extremes {
  double least = 0.0;
  double greatest = 0.0;

  [[nodiscard]] double half_range() const { return greatest / 2 - least / 2; }
  [[nodiscard]] double middle() const { return least + half_range(); }
  [[nodiscard]] double largest_magnitude() const { return std::max(greatest, -least); }
};

/// Returns the least and greatest of values that are no NaN, at least one.
[[nodiscard]] inline Extremes ExtremesOf(std::span<const double> values) {
  // Eigen compares several values at once, which compilers may not of a loop.
  const Eigen::Map<const Eigen::ArrayXd> array(values.data(), std::ssize(values));
  return {array.minCoeff(), array.maxCoeff()};
}

}  // namespace mindahl
