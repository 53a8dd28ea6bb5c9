#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "identification/candidate.h"
#include "identification/displacement_errors.h"
#include "identification/scaled_records.h"
#include "mindahl/identification/fit.h"

namespace mindahl::identification {

/// Gives weight 0 to what options leave out: samples outside the load window, and the first cycles.
/// @returns the samples left out, one number a record
/// @throws InvalidArgument where a record has no normal load for a window, or nothing is left
std::vector<std::size_t> LeaveOut(ScaledRecords& data, std::span<const loop::Record> records,
                                  std::span<const std::vector<std::size_t>> reversals,
                                  const FitOptions& options);

/// The noise that the weights of a fit stand for, in units of the data.
struct WeightedNoise {
  double variance = 0.0;     // of a weighted residual, for covariances
  double force_noise = 0.0;  // of the force alone
  std::size_t outliers = 0;  // samples at less than half their weight
  bool converged = true;
  /// σ_F/√(σ_F² + σ_T²) of each sample; empty where the displacement is exact
  std::vector<double> force_share;
};

/// The variance of plain residuals: known, or from their sum of squares.
WeightedNoise PlainNoise(const Candidate& candidate, const ScaledRecords& data,
                         const FitOptions& options);

/// Fits again and again under the weights that the last fit implies, until they settle:
/// - errors of the displacement act as force noise of the variance σ_T² that their draws have at a
///   sample (effective variance, Orear 1982): w = σ_F²/(σ_F² + σ_T²), so that steep branches do not
///   dominate; σ_F² where it is not known is what the residuals leave for it
/// - a robust loss: w·ψ(z)/z of the standardised residual z, whose scale is the median absolute
///   deviation; Huber 1.345, Cauchy 2.385, Tukey 4.685, each 95 % efficient for normal noise
/// @param candidate  refitted from where it is
WeightedNoise FitWithWeights(Candidate& candidate, ScaledRecords& data, const FitOptions& options,
                             const DisplacementErrors& displacement_errors);

}  // namespace mindahl::identification
