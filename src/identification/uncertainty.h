#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "identification/force_residual.h"
#include "identification/noise_model.h"
#include "identification/parameter_layout.h"

namespace mindahl::identification {

/// What the Jacobian at the solution says about the free parameters, before any noise level is put
/// in: covariance = variance of a residual × `factor`.
struct LocalUncertainty {
  std::vector<std::size_t> columns;  // positions in theta, those not held at a bound
  /// columns² row-major: (JᵀJ)⁻¹·JᵀRJ·(JᵀJ)⁻¹ on the determined subspace, R the correlation of the
  /// residuals; with errors of the displacement, JᵀSRSJ + JᵀEEᵀJ/(K s²), S the force's share of the
  /// noise and E the K drawn residuals
  std::vector<double> factor;
  std::vector<double> white_factor;  // the diagonal of (JᵀJ)⁻¹: what white residuals would give
  /// Residuals' worth of noise that the fit takes up, tr((JᵀJ)⁻¹JᵀRJ): the number of parameters
  /// where the residuals are white, more where they hang together as the response does.
  double absorbed = 0.0;
  std::vector<bool> determined;           // of each column: no part in a direction without effect
  std::vector<std::vector<double>> null;  // directions in θ without effect on the residual

  [[nodiscard]] double Factor(std::size_t row, std::size_t column) const {
    return factor[row * columns.size() + column];
  }
};

/// What errors of the displacement add to a fit's uncertainty.
struct DisplacementEffect {
  Eigen::MatrixXd residuals;        // drawn, weighted: rows as the Jacobian's; none where exact
  double variance = 1.0;            // of a residual, in whose units factors are
  std::vector<double> force_share;  // of the noise of each residual, that of the force alone
};

/// Singular value decomposition of the Jacobian, columns scaled to unit norm: never fails, and
/// names the directions that the data leave open where it is rank deficient.
/// @param columns  positions in theta to differentiate by
/// @param rows     samples of each record
LocalUncertainty AnalyseJacobian(const ForceResidual& residual, const std::vector<double>& theta,
                                 std::vector<std::size_t> columns, const NoiseModel& noise,
                                 std::span<const std::size_t> rows,
                                 const DisplacementEffect& displacement);

}  // namespace mindahl::identification
