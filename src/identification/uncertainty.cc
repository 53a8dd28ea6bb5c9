#include "identification/uncertainty.h"

#include <Eigen/Dense>
#include <cmath>
#include <utility>

namespace mindahl::identification {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Singular values below this share of the largest are rounding of a Jacobian of unit columns.
constexpr double kRankTolerance = 1e-11;
/// A parameter with more than this component in a null direction is not determined.
constexpr double kNullComponent = 1e-3;

}  // namespace

LocalUncertainty AnalyseJacobian(const ForceResidual& residual, const std::vector<double>& theta,
                                 std::vector<std::size_t> columns, const NoiseModel& noise,
                                 std::span<const std::size_t> record_rows,
                                 const DisplacementEffect& displacement) {
  LocalUncertainty result;
  result.columns = std::move(columns);
  const std::size_t count = result.columns.size();
  result.factor.assign(count * count, 0.0);
  result.white_factor.assign(count, 0.0);
  result.determined.assign(count, true);
  if (count == 0) return result;

  const auto rows = static_cast<Eigen::Index>(residual.size());
  const auto size = static_cast<Eigen::Index>(count);
  std::vector<double> values(residual.size());
  RowMajorMatrix jacobian(rows, size);
  residual.Differentiate(theta, result.columns, values,
                         {jacobian.data(), static_cast<std::size_t>(jacobian.size())});

  Eigen::VectorXd norms = jacobian.colwise().norm().transpose();
  for (Eigen::Index j = 0; j < size; ++j) {
    if (norms[j] == 0) norms[j] = 1;
    jacobian.col(j) /= norms[j];
  }
  // R of J = QR has J's singular values and is small, however long the record.
  const Eigen::MatrixXd triangle = Eigen::HouseholderQR<Eigen::MatrixXd>(jacobian)
                                       .matrixQR()
                                       .topRows(std::min(rows, size))
                                       .triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(triangle, Eigen::ComputeFullV);
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const double value = k < svd.singularValues().size() ? svd.singularValues()[k] : 0.0;
    const Eigen::VectorXd direction = svd.matrixV().col(k);
    if (value > kRankTolerance * svd.singularValues()[0]) {
      factor += direction * direction.transpose() / (value * value);
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
  Eigen::MatrixXd correlated = Eigen::MatrixXd::Zero(size, size);
  if (displacement.residuals.size() > 0) {
    const Eigen::MatrixXd drawn = jacobian.transpose() * displacement.residuals;
    correlated =
        drawn * drawn.transpose() / (static_cast<double>(drawn.cols()) * displacement.variance);
    jacobian.array().colwise() *=
        Eigen::Map<const Eigen::ArrayXd>(displacement.force_share.data(), rows);
  }
  Eigen::Index begin = 0;
  for (const std::size_t samples : record_rows) {
    const std::vector<double> part =
        noise.Quadratic({jacobian.row(begin).data(), samples * count}, count);
    correlated += Eigen::Map<const Eigen::MatrixXd>(part.data(), size, size);
    begin += static_cast<Eigen::Index>(samples);
  }
  result.absorbed = (factor * correlated).trace();
  const Eigen::MatrixXd product = factor * correlated * factor;
  const Eigen::MatrixXd sandwich = (product + product.transpose()) / 2;  // to the last bit
  for (Eigen::Index i = 0; i < size; ++i) {
    result.white_factor[static_cast<std::size_t>(i)] = factor(i, i) / (norms[i] * norms[i]);
    for (Eigen::Index j = 0; j < size; ++j) {
      result.factor[static_cast<std::size_t>(i * size + j)] =
          sandwich(i, j) / (norms[i] * norms[j]);
    }
  }
  return result;
}

}  // namespace mindahl::identification
