#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace mindahl::identification {

/// How a fit's residuals hang together: an autoregressive process, the same for all records,
///   r_t = Σ φ_k r_{t−k} + ε_t,  k = 1 … p
/// found by Yule and Walker's equations (which make it stable), its order by Schwarz's criterion.
/// Loops leave residuals that are never white: what a model misses is smooth along the loop.
struct NoiseModel {
  std::vector<double> coefficients;  // φ₁ … φ_p; none when the residuals are white
  double innovation_share = 1.0;     // variance of ε over that of r

  /// 1 + 2Σρ_k² over all lags: as many correlated residuals tell a variance as well as one
  /// independent one does (Bartlett 1946).
  [[nodiscard]] double SquaredCorrelations() const;

  /// JᵀRJ with R the correlation matrix of one record's residuals, without ever forming it: the
  /// rows are filtered backwards by 1/φ, on into the past until they have died away.
  /// @param jacobian  row-major, rows of one record in order of time
  /// @returns columns², row-major; relative error below 1e-8
  [[nodiscard]] std::vector<double> Quadratic(std::span<const double> jacobian,
                                              std::size_t columns) const;
};

/// @param residuals  one series a record; an exact 0 is a sample that does not count
NoiseModel EstimateNoise(std::span<const std::vector<double>> residuals);

}  // namespace mindahl::identification
