#pragma once

#include <cstddef>
#include <vector>

#include "identification/force_residual.h"
#include "identification/parameter_layout.h"

namespace mindahl {

/// What the Jacobian at the solution says about the free parameters, before any noise level is put
/// in: covariance = variance of a residual × `factor`.
struct LocalUncertainty {
  std::vector<std::size_t> columns;  // positions in theta, those not held at a bound
  std::vector<double> factor;        // columns² row-major, (JᵀJ)⁻¹ on the determined subspace
  std::vector<bool> determined;      // of each column: no part in a direction without effect
  std::vector<std::vector<double>> null;  // directions in θ without effect on the residual

  [[nodiscard]] double Factor(std::size_t row, std::size_t column) const {
    return factor[row * columns.size() + column];
  }
};

/// Singular value decomposition of the Jacobian, columns scaled to unit norm: never fails, and
/// names the directions that the data leave open where it is rank deficient.
/// @param columns  positions in theta to differentiate by
LocalUncertainty AnalyseJacobian(const ForceResidual& residual, const std::vector<double>& theta,
                                 std::vector<std::size_t> columns);

}  // namespace mindahl
