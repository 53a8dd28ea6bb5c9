#pragma once

#include <cstddef>

#include "identification/inference/noise.h"

namespace mindahl::identification {

/// Compares two fits to the same samples; every comparison of fits uses it.
class Evidence {
 public:
  /// @param samples    that count
  /// @param effective  as many independent ones as say the same, of what is compared
  Evidence(std::size_t samples, double effective);

  /// Takes the sample size over the variance inflation from autocorrelation.
  explicit Evidence(const Noise& noise) : Evidence(noise.samples, noise.effective_samples()) {}

  /// 2 ln Λ of the fit with the smaller sum of squares against the other: n_eff·ln(SS₀/SS₁), of
  /// sums that are both no less than rounding errors leave.
  [[nodiscard]] double LikelihoodRatio(double held, double free) const;

  /// Returns the same statistic where its distribution is asked for: F = (SS₀ − SS₁)/s²·n_eff/n of
  /// one more parameter, s² the variance of a residual.
  [[nodiscard]] double FStatistic(double held, double free, double variance) const;

  /// Akaike's criterion with its small-sample term (Hurvich & Tsai 1989), for Gaussian residuals of
  /// unknown variance. The effective samples weigh the likelihood only: a wrong law leaves a
  /// handful of them, for which the small-sample term would outweigh any difference of two fits.
  [[nodiscard]] double Aicc(double sum_of_squares, std::size_t parameters) const;

 private:
  [[nodiscard]] double Floored(double sum_of_squares) const;

  double samples_;
  double effective_;
};

}  // namespace mindahl::identification
