#pragma once

#include <cstddef>
#include <span>

#include "identification/candidate.h"
#include "identification/uncertainty.h"

namespace mindahl::identification {

/// Values, standard errors, intervals and correlations of one fit, from the likelihood's parabola
/// at its maximum.
class Estimator {
 public:
  /// @param candidate  must outlive this
  /// @param variance   of a residual, in units of the data, inflated for what repeats every stroke
  /// @param rows       samples of each record
  /// @param samples    that count, of which the variance was estimated; 0 when it is known
  Estimator(const Candidate& candidate, double variance, const NoiseModel& noise,
            std::span<const std::size_t> rows, double degrees_of_freedom,
            const DisplacementEffect& displacement, std::size_t samples);

  /// @param index  position in theta
  [[nodiscard]] ParameterEstimate Estimate(std::size_t index) const;

  /// NaN where either parameter is fixed, at a bound or undetermined.
  [[nodiscard]] double Correlation(std::size_t row, std::size_t column) const;

  /// Directions in θ that leave the response as it is.
  [[nodiscard]] const LocalUncertainty& local() const { return full_; }
  /// Variance of the parameter if residuals were white and did not repeat, over what it is: by
  /// this share a likelihood ratio counts. 1 where it is not determined.
  [[nodiscard]] double WhiteShare(std::size_t index, double white_variance) const;
  /// Half width of a 95 % interval in standard errors.
  [[nodiscard]] double quantile() const { return quantile_; }

 private:
  [[nodiscard]] double ScaleSign(std::size_t index) const;

  const Candidate& candidate_;
  double quantile_;
  double variance_;
  LocalUncertainty conditional_;  // of the parameters inside their bounds, the others held there
  LocalUncertainty full_;         // of all free parameters
};

}  // namespace mindahl::identification
