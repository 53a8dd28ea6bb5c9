#include "identification/inference/local.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/solve/turning_points.h"

namespace mindahl::identification {
namespace {

/// Singular values below this share of the largest are rounding of a Jacobian of unit columns.
constexpr double kRankTolerance = 1e-11;
/// A parameter with more than this component in a null direction is not determined.
constexpr double kNullComponent = 1e-3;

}  // namespace

std::size_t LocalUncertainty::PlaceOf(std::size_t parameter) const {
  return static_cast<std::size_t>(std::ranges::find(columns, parameter) - columns.begin());
}

Eigen::MatrixXd JacobianAt(const Problem& problem, std::span<const double> theta,
                           Response& response, std::span<const std::size_t> columns,
                           Eigen::VectorXd& residual) {
  const auto rows = static_cast<Eigen::Index>(problem.size());
  Eigen::MatrixXd jacobian(rows, static_cast<Eigen::Index>(columns.size()));
  residual.resize(rows);
  response.Bind(problem);
  Differentiate(problem, theta, response, columns, {residual.data(), problem.size()},
                {jacobian.data(), static_cast<std::size_t>(jacobian.size())});
  if (HasTurningPoints(*problem.data)) {
    const TurningPointColumns turning(problem, theta, response);
    for (Eigen::Index c = 0; c < jacobian.cols(); ++c) turning.ProjectOut(jacobian.col(c));
  }
  return jacobian;
}

Autocorrelation AutocorrelationOf(const ScaledRecords& data, std::span<const double> residual,
                                  std::span<const unsigned char> tells,
                                  std::pmr::memory_resource* memory) {
  std::pmr::vector<std::span<const double>> series(memory);
  std::pmr::vector<std::span<const unsigned char>> counts(memory);
  series.reserve(data.records.size());
  counts.reserve(data.records.size());
  std::size_t begin = 0;
  for (const ScaledRecord& record : data.records) {
    series.push_back(residual.subspan(begin, record.size()));
    counts.push_back(tells.empty() ? std::span<const unsigned char>(record.counts)
                                   : tells.subspan(begin, record.size()));
    begin += record.size();
  }
  return EstimateAutocorrelation(series, counts);
}

double EffectiveSamples(const Problem& problem, std::span<const double> theta, Response& response,
                        std::pmr::memory_resource* memory) {
  std::pmr::vector<double> residual(problem.size(), memory);
  EvaluateResidual(problem, theta, response, residual);
  return static_cast<double>(problem.data->counted) /
         AutocorrelationOf(*problem.data, residual, {}, memory).SquaredCorrelations();
}

Eigen::MatrixXd CorrelatedProduct(const ScaledRecords& data, const Autocorrelation& autocorrelation,
                                  const Eigen::MatrixXd& jacobian) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  Eigen::Index begin = 0;
  for (const ScaledRecord& record : data.records) {
    const auto rows = static_cast<Eigen::Index>(record.size());
    product += autocorrelation.Quadratic(jacobian.middleRows(begin, rows));
    begin += rows;
  }
  return product;
}

Eigen::MatrixXd CorrelatedProduct(const ScaledRecords& data, const Autocorrelation& autocorrelation,
                                  const Noise& noise, const DisplacementEffect& displacement,
                                  const Eigen::MatrixXd& jacobian) {
  const Eigen::MatrixXd drawn = jacobian.transpose() * displacement.residuals;
  const Eigen::Map<const Eigen::VectorXd> share(noise.force_share.data(), jacobian.rows());
  return drawn * drawn.transpose() / (static_cast<double>(drawn.cols()) * displacement.variance) +
         CorrelatedProduct(data, autocorrelation, share.asDiagonal() * jacobian);
}

LocalUncertainty AnalyseJacobian(const Problem& problem, std::vector<std::size_t> columns,
                                 Eigen::MatrixXd jacobian, const Noise& noise,
                                 const DisplacementEffect& displacement) {
  LocalUncertainty result;
  result.columns = std::move(columns);
  const std::size_t count = result.columns.size();
  const auto size = static_cast<Eigen::Index>(count);
  result.factor = Eigen::MatrixXd::Zero(size, size);
  result.white_factor = Eigen::VectorXd::Zero(size);
  result.determined.assign(count, true);
  if (count == 0) return result;

  const Eigen::Index rows = jacobian.rows();
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
  const Eigen::MatrixXd correlated =
      displacement.residuals.size() > 0
          ? CorrelatedProduct(*problem.data, noise.autocorrelation, noise, displacement, jacobian)
          : CorrelatedProduct(*problem.data, noise.autocorrelation, jacobian);
  result.absorbed = (factor * correlated).trace();
  const Eigen::MatrixXd product = factor * correlated * factor;
  const Eigen::MatrixXd sandwich = (product + product.transpose()) / 2;  // to the last bit
  for (Eigen::Index i = 0; i < size; ++i) {
    result.white_factor[i] = factor(i, i) / (norms[i] * norms[i]);
    for (Eigen::Index j = 0; j < size; ++j) {
      result.factor(i, j) = sandwich(i, j) / (norms[i] * norms[j]);
    }
  }
  return result;
}

}  // namespace mindahl::identification
