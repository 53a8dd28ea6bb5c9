#pragma once

#include <cstddef>
#include <span>

namespace mindahl::identification {

struct ResidualStatistics {
  double rms = 0.0;             ///< [N] √(Σr²/n)
  double max_abs = 0.0;         ///< [N]
  double normalized_rms = 0.0;  ///< [–] rms over Tc
  double r_squared = 0.0;       ///< [–] 1 − Σr²/Σ(T − mean)²
  double durbin_watson = 0.0;  ///< [–] Σ(rᵢ − rᵢ₋₁)²/Σr²: 2 when white, → 0 when correlated
  /// Number of independent residuals of equal information: n/(1 + 2Σρ²), ρ the correlations of an
  /// autoregressive process (Bartlett 1946), over the strokes in which a fraction of them repeats
  double effective_samples = 0.0;
  double degrees_of_freedom = 0.0;  ///< effective samples less the free parameters, at least 1
  std::size_t samples = 0;
};

/// @param residuals   [N] fitted − measured, one series a record; differences are taken within a
/// record
/// @param forces      [N] measured, of the same sizes
/// @param slip_force  [N] Tc
/// @throws InvalidArgument when sizes differ or there is no sample
/// Effective samples and degrees of freedom are left to who knows the noise: 0.
ResidualStatistics DescribeResiduals(std::span<const std::span<const double>> residuals,
                                     std::span<const std::span<const double>> forces,
                                     double slip_force);

}  // namespace mindahl::identification
