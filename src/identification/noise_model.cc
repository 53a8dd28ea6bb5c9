#include "identification/noise_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace mindahl::identification {
namespace {

constexpr std::size_t kHighestOrder = 12;
constexpr std::size_t kSamplesPerOrder = 10;
/// What a filter remembers below this share of its largest output is rounding.
constexpr double kForgotten = 1e-9;
constexpr std::size_t kLongest = 100'000;  // samples that it is given to forget

/// Means of r_t·r_{t+k} over pairs that both count, k = 0 … order, each times the share of lags
/// that a series of this length has: without gaps that keeps the sequence positive definite.
std::vector<double> Autocovariances(std::span<const std::vector<double>> residuals,
                                    std::size_t order) {
  std::size_t samples = 0;
  for (const std::vector<double>& series : residuals) samples += series.size();
  std::vector<double> covariances;
  for (std::size_t lag = 0; lag <= order; ++lag) {
    double sum = 0.0;
    std::size_t pairs = 0;
    std::size_t counting = 0;
    for (const std::vector<double>& series : residuals) {
      for (std::size_t i = lag; i < series.size(); ++i) {
        const double product = series[i] * series[i - lag];
        sum += product;
        ++pairs;
        if (product != 0) ++counting;
      }
    }
    const double mean = counting > 0 ? sum / static_cast<double>(counting) : 0.0;
    covariances.push_back(mean * static_cast<double>(pairs) /
                          static_cast<double>(std::max<std::size_t>(samples, 1)));
  }
  return covariances;
}

std::size_t CountOf(std::span<const std::vector<double>> residuals) {
  std::size_t count = 0;
  for (const std::vector<double>& series : residuals) {
    count += static_cast<std::size_t>(
        std::ranges::count_if(series, [](double residual) { return residual != 0; }));
  }
  return count;
}

}  // namespace

NoiseModel EstimateNoise(std::span<const std::vector<double>> residuals) {
  NoiseModel best;
  const std::size_t count = CountOf(residuals);
  const std::size_t highest = std::min(kHighestOrder, count / kSamplesPerOrder);
  const std::vector<double> covariance = Autocovariances(residuals, highest);
  if (!(covariance[0] > 0)) return best;

  // Levinson and Durbin: each order from the one before.
  const auto samples = static_cast<double>(count);
  std::vector<double> coefficients;
  double variance = covariance[0];
  double best_criterion = 0.0;  // of order 0, by how much others are better
  for (std::size_t order = 1; order <= highest; ++order) {
    double numerator = covariance[order];
    for (std::size_t k = 1; k < order; ++k)
      numerator -= coefficients[k - 1] * covariance[order - k];
    const double reflection = numerator / variance;
    std::vector<double> next(order);
    for (std::size_t k = 1; k < order; ++k) {
      next[k - 1] = coefficients[k - 1] - reflection * coefficients[order - k - 1];
    }
    next[order - 1] = reflection;
    coefficients = std::move(next);
    variance *= 1 - reflection * reflection;
    if (!(variance > 0)) break;
    const double criterion = samples * std::log(variance / covariance[0]) +
                             static_cast<double>(order) * std::log(samples);
    if (criterion < best_criterion) {
      best_criterion = criterion;
      best = {coefficients, variance / covariance[0]};
    }
  }
  return best;
}

double NoiseModel::SquaredCorrelations() const {
  if (coefficients.empty()) return 1.0;
  // ρ_k through the impulse response: ρ_k = Σ_j ψ_j ψ_{j+k}·share.
  std::vector<double> impulse = {1.0};
  double largest = 1.0;
  while (impulse.size() < kLongest) {
    double value = 0.0;
    for (std::size_t k = 1; k <= coefficients.size() && k <= impulse.size(); ++k) {
      value += coefficients[k - 1] * impulse[impulse.size() - k];
    }
    impulse.push_back(value);
    largest = std::max(largest, std::abs(value));
    const std::size_t recent = coefficients.size();
    if (impulse.size() > recent &&
        std::all_of(impulse.end() - static_cast<std::ptrdiff_t>(recent), impulse.end(),
                    [&](double x) { return std::abs(x) < kForgotten * largest; })) {
      break;
    }
  }
  // ρ_k itself obeys the recursion, from its first p values on: those by the sum.
  const std::size_t order = coefficients.size();
  std::vector<double> rho;
  for (std::size_t lag = 0; lag <= order; ++lag) {
    double sum = 0.0;
    for (std::size_t j = 0; j + lag < impulse.size(); ++j) sum += impulse[j] * impulse[j + lag];
    rho.push_back(sum * innovation_share);
  }
  while (rho.size() < impulse.size()) {
    double value = 0.0;
    for (std::size_t k = 1; k <= order; ++k) value += coefficients[k - 1] * rho[rho.size() - k];
    rho.push_back(value);
  }
  double sum = 1.0;
  for (std::size_t lag = 1; lag < rho.size(); ++lag) sum += 2 * rho[lag] * rho[lag];
  return sum;
}

std::vector<double> NoiseModel::Quadratic(std::span<const double> jacobian,
                                          std::size_t columns) const {
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto width = static_cast<Eigen::Index>(columns);
  const Eigen::Map<const RowMajorMatrix> rows(
      jacobian.data(), static_cast<Eigen::Index>(jacobian.size() / columns), width);
  std::vector<double> result(columns * columns);
  Eigen::Map<RowMajorMatrix> sum(result.data(), width, width);
  if (coefficients.empty()) {
    sum.noalias() = rows.transpose() * rows;
    return result;
  }
  sum.setZero();
  // The last `order` outputs, newest first.
  const auto order = static_cast<Eigen::Index>(coefficients.size());
  Eigen::MatrixXd recent = Eigen::MatrixXd::Zero(order, width);
  const Eigen::Map<const Eigen::RowVectorXd> phi(coefficients.data(), order);
  double largest = 0.0;
  const auto step = [&](const Eigen::RowVectorXd& input) {
    const Eigen::RowVectorXd output = input + phi * recent;
    for (Eigen::Index k = order - 1; k > 0; --k) recent.row(k) = recent.row(k - 1);
    recent.row(0) = output;
    sum.noalias() += output.transpose() * output;
    largest = std::max(largest, output.cwiseAbs().maxCoeff());
  };
  for (Eigen::Index row = rows.rows() - 1; row >= 0; --row) step(rows.row(row));
  const Eigen::RowVectorXd nothing = Eigen::RowVectorXd::Zero(width);
  for (std::size_t i = 0; i < kLongest; ++i) {
    if (recent.cwiseAbs().maxCoeff() < kForgotten * largest) break;
    step(nothing);
  }
  sum *= innovation_share;
  return result;
}

}  // namespace mindahl::identification
