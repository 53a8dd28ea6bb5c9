#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "identification/inference/noise.h"
#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Holds the uncertainty of the free parameters by the Jacobian at the solution, without a noise
/// level: covariance = variance of a residual × `factor`.
struct LocalUncertainty {
  /// A row and a column a free parameter: (JᵀJ)⁻¹·JᵀRJ·(JᵀJ)⁻¹ on the determined subspace, R the
  /// correlation of the residuals; with errors of the displacement, JᵀSRSJ + JᵀEEᵀJ/(K s²), S the
  /// force's fraction of the noise and E the K drawn residuals
  Eigen::MatrixXd factor;
  Eigen::MatrixXd white_factor;  // (JᵀJ)⁻¹: what white residuals would give
  /// Residuals' worth of noise that the fit takes up, tr((JᵀJ)⁻¹JᵀRJ): the number of parameters
  /// where the residuals are white, more where they are autocorrelated as the response is.
  double absorbed = 0.0;
  std::vector<bool> determined;           // of each: no part in a direction without effect
  std::vector<std::vector<double>> null;  // directions in θ without effect on the residual
};

/// A problem near one point.
struct Linearization {
  Eigen::MatrixXd jacobian;  // weighted
  Eigen::VectorXd residual;  // weighted, model − measured
};

/// @param columns  positions in θ to differentiate by
Linearization LinearizeAt(const Problem& problem, std::span<const double> theta, Response& response,
                          std::span<const std::size_t> columns);

/// Returns the effective number of samples of residuals, weighted or not, one record after the
/// other: those that count, over the variance inflation from autocorrelation.
double EffectiveSamples(const ScaledRecords& data, std::span<const double> residual);

/// Returns the same of a solution's residuals, no fewer than determine its free parameters. Binds
/// the response to the problem.
double EffectiveSamples(const Problem& problem, std::span<const double> theta, Response& response);

/// JᵀRJ of all records, each times its own variance over that of all; where the displacement has
/// errors JᵀSRSJ + JᵀEEᵀJ/(K s²), as of LocalUncertainty.
/// @param drawn  weighted residuals that errors of the displacement make, a column a draw, rows as
///               the Jacobian's; none where it is exact
Eigen::MatrixXd CorrelatedProduct(const ScaledRecords& data, const Autocorrelation& autocorrelation,
                                  const Noise& noise, const Eigen::MatrixXd& drawn,
                                  const Eigen::MatrixXd& jacobian);

/// Singular value decomposition of the Jacobian, columns scaled to unit norm: never fails, and
/// names the directions that the data leave open where it is rank deficient.
/// @param jacobian  by all free parameters
/// @param drawn     as of CorrelatedProduct()
LocalUncertainty AnalyseJacobian(const Problem& problem, const Eigen::MatrixXd& jacobian,
                                 const Noise& noise, const Eigen::MatrixXd& drawn);

}  // namespace mindahl::identification
