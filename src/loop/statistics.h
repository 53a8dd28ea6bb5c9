#pragma once

#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace mindahl::loop {

/// Returns the mean of at least one value.
inline double Mean(std::span<const double> values) {
  return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

/// Returns the middle of at least one value; of an even number the mean of the two. Reorders them.
template <typename Values>
double Median(Values&& values) {
  return boost::math::statistics::median(values.begin(), values.end());
}

/// Standard deviation of normal values over the median of their size, 1/Φ⁻¹(3/4).
inline constexpr double kDeviationOverMedian = 1.482602218505602;

/// Returns the standard deviation of white noise by the median size of the differences of an order,
/// of which what is smooth, turns and knees leave little; 0 for too few values. The variance of a
/// difference of order k is C(2k, k) times the noise's.
inline double NoiseByDifferences(std::span<const double> values, std::size_t order) {
  if (values.size() <= order) return 0.0;
  std::vector<double> differences(values.begin(), values.end());
  double variance = 1.0;  // of a difference over the noise's
  for (std::size_t k = 1; k <= order; ++k) {
    std::adjacent_difference(differences.begin(), differences.end(), differences.begin());
    variance *= 2.0 * static_cast<double>(2 * k - 1) / static_cast<double>(k);
  }
  differences.erase(differences.begin(), differences.begin() + static_cast<std::ptrdiff_t>(order));
  for (double& difference : differences) difference = std::abs(difference);
  return kDeviationOverMedian * Median(differences) / std::sqrt(variance);
}

}  // namespace mindahl::loop
