#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace mindahl::identification {

struct ResidualStatistics {
  double rms = 0.0;             ///< [N] √(Σr²/n)
  double max_abs = 0.0;         ///< [N]
  double normalized_rms = 0.0;  ///< [–] rms over Tc
  double r_squared = 0.0;       ///< [–] 1 − Σr²/Σ(T − mean)²
  double durbin_watson = 0.0;  ///< [–] Σ(rᵢ − rᵢ₋₁)²/Σr²: 2 when white, → 0 when correlated
  /// n·(1 − ρ)/(1 + ρ) with ρ = 1 − DW/2 the lag-one autocorrelation, where positive
  double effective_samples = 0.0;
  double degrees_of_freedom = 0.0;  ///< effective samples less the free parameters, at least 1
  std::size_t samples = 0;
};

/// @param residuals   [N] fitted − measured, one series a record; differences are taken within a
/// record
/// @param forces      [N] measured, of the same sizes
/// @param slip_force  [N] Tc
/// @param free_parameters  number estimated
/// @throws InvalidArgument when sizes differ or there is no sample
ResidualStatistics DescribeResiduals(std::span<const std::vector<double>> residuals,
                                     std::span<const std::vector<double>> forces, double slip_force,
                                     std::size_t free_parameters);

}  // namespace mindahl::identification
