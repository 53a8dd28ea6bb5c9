#pragma once

#include <cmath>

namespace mindahl::identification {

/// Returns the standard deviation of the prior of the backbone's second differences: that of the
/// noise over the root of the prior's precision, so many times as large as the effective samples
/// are fewer than the samples.
/// @param variance  of the noise of a sample
/// @param weight    of the squared second differences in the sum of squares
inline double DeviationOfPrior(double variance, double samples, double effective_samples,
                               double weight) {
  return std::sqrt(variance * samples / effective_samples * weight);
}

}  // namespace mindahl::identification
