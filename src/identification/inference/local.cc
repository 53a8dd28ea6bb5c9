#include "identification/inference/local.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace mindahl::identification {
namespace {

/// Singular values below this fraction of the largest are rounding of a Jacobian of unit columns.
constexpr double kRankTolerance = 1e-11;
/// A parameter with more than this component in a null direction is not determined.
constexpr double kNullComponent = 1e-3;

/// Returns R of J = QR, of as many rows as J has columns, which has J's singular values and is
/// small, however long the record.
Eigen::MatrixXd TriangleOf(const Eigen::MatrixXd& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> factors(columns);
  Eigen::MatrixXd triangle = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  const Eigen::Index rows = std::min(columns.cols(), columns.rows());
  triangle.topRows(rows) = factors.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  return triangle;
}

/// Returns H with HHᵀ = (RᵀR)⁻¹ on the directions with an effect, a column each, and names those
/// without.
Eigen::MatrixXd HalfOfPseudoInverse(const Eigen::MatrixXd& triangle, const Eigen::VectorXd& norms,
                                    LocalUncertainty& result) {
  const Eigen::Index size = triangle.cols();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(triangle, Eigen::ComputeFullV);
  Eigen::MatrixXd half(size, size);
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < size; ++k) {
    const double value = svd.singularValues()[k];
    const Eigen::VectorXd direction = svd.matrixV().col(k);
    if (value > kRankTolerance * svd.singularValues()[0]) {
      half.col(rank++) = direction / value;
      continue;
    }
    const Eigen::VectorXd in_theta = direction.cwiseQuotient(norms);
    result.null.emplace_back(in_theta.begin(), in_theta.end());
    for (Eigen::Index j = 0; j < size; ++j) {
      if (std::abs(direction[j]) > kNullComponent) {
        result.determined[static_cast<std::size_t>(j)] = false;
      }
    }
  }
  return half.leftCols(rank);
}

/// Returns a root L of a symmetric matrix, LLᵀ = M, without what rounding leaves below zero.
Eigen::MatrixXd RootOf(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return matrix;  // which Eigen's solver does not take
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> pairs((matrix + matrix.transpose()) / 2);
  return pairs.eigenvectors() * pairs.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

Linearization LinearizeAt(const Problem& problem, std::span<const double> theta, Response& response,
                          std::span<const std::size_t> columns) {
  const std::size_t samples = problem.size();
  const auto rows = static_cast<Eigen::Index>(samples);
  Linearization at{.jacobian = Eigen::MatrixXd(rows, static_cast<Eigen::Index>(columns.size())),
                   .residual = Eigen::VectorXd(rows)};
  response.Bind(problem);
  Differentiate(problem, theta, response, columns, {at.residual.data(), samples},
                {at.jacobian.data(), static_cast<std::size_t>(at.jacobian.size())});
  return at;
}

double EffectiveSamples(const ScaledRecords& data, std::span<const double> residual) {
  return static_cast<double>(data.counted) /
         EstimateAutocorrelation(data.records, residual).SquaredCorrelations();
}

double EffectiveSamples(const Problem& problem, std::span<const double> theta, Response& response) {
  std::vector<double> residual(problem.size());
  EvaluateResidual(problem, theta, response, residual);
  const auto least = static_cast<double>(problem.parameters.free().size() + 1);
  return std::max(EffectiveSamples(*problem.data, residual), least);
}

Eigen::MatrixXd CorrelatedProduct(const ScaledRecords& data, const Autocorrelation& autocorrelation,
                                  const Noise& noise, const Eigen::MatrixXd& drawn,
                                  const Eigen::MatrixXd& jacobian) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  Eigen::MatrixXd of_force = jacobian;
  if (drawn.size() > 0) {
    const Eigen::MatrixXd moved = jacobian.transpose() * drawn;
    product = moved * moved.transpose() /
              (static_cast<double>(drawn.cols()) * (noise.variance * noise.repeating));
    const Eigen::Map<const Eigen::VectorXd> share(noise.force_share.data(), jacobian.rows());
    of_force = share.asDiagonal() * jacobian;
  }
  Eigen::Index begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const auto rows = static_cast<Eigen::Index>(data.records[r].size());
    const double variance = noise.of_records.empty() ? 1.0 : noise.of_records[r];
    product += variance * autocorrelation.Quadratic(of_force.middleRows(begin, rows));
    begin += rows;
  }
  return product;
}

LocalUncertainty AnalyseJacobian(const Problem& problem, const Eigen::MatrixXd& jacobian,
                                 const Noise& noise, const Eigen::MatrixXd& drawn) {
  LocalUncertainty result;
  const std::vector<std::size_t>& free = problem.parameters.free();
  const Eigen::Index size = std::ssize(free);
  result.factor = result.white_factor = Eigen::MatrixXd::Zero(size, size);
  result.determined.assign(free.size(), true);
  if (size == 0) return result;

  // A prior is one more reading, with the noise of the others.
  Eigen::MatrixXd priors = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    priors(j, j) = problem.parameters[free[static_cast<std::size_t>(j)]].prior_root_weight;
  }
  const bool any_prior = !priors.isZero(0.0);
  const bool is_white =
      drawn.size() == 0 && noise.autocorrelation.order == 0 && noise.of_records.empty();
  Eigen::MatrixXd triangle = TriangleOf(jacobian);
  if (any_prior) {
    Eigen::MatrixXd rows(2 * size, size);
    rows << triangle, priors;
    triangle = TriangleOf(rows);
  }
  Eigen::VectorXd norms = triangle.colwise().norm();
  for (double& norm : norms) norm = norm == 0 ? 1.0 : norm;
  // Columns are scaled to one, whatever their units.
  const Eigen::VectorXd inverse_norms = norms.cwiseInverse();
  triangle *= inverse_norms.asDiagonal();
  const Eigen::MatrixXd half = HalfOfPseudoInverse(triangle, norms, result);
  // The columns U = JH are orthonormal, so that the noise makes a product UᵀRU of order one:
  // between two inverses of an ill-conditioned JᵀJ its rounding errors would outgrow it.
  Eigen::MatrixXd root = half;
  result.absorbed = static_cast<double>(half.cols());
  if (!is_white) {
    const Eigen::MatrixXd orthonormal = jacobian * (inverse_norms.asDiagonal() * half);
    Eigen::MatrixXd product =
        CorrelatedProduct(*problem.data, noise.autocorrelation, noise, drawn, orthonormal);
    result.absorbed = product.trace();
    const Eigen::MatrixXd of_priors = priors * (inverse_norms.asDiagonal() * half);
    product += of_priors.transpose() * of_priors;
    root = half * RootOf(product);
  }
  const Eigen::MatrixXd in_theta = inverse_norms.asDiagonal() * root;
  const Eigen::MatrixXd white_in_theta = inverse_norms.asDiagonal() * half;
  // Element by element: symmetric to the last bit.
  result.factor = in_theta.lazyProduct(in_theta.transpose());
  result.white_factor = white_in_theta.lazyProduct(white_in_theta.transpose());
  return result;
}

}  // namespace mindahl::identification
