#include "identification/turning_points.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "mindahl/identification/residual_statistics.h"

namespace mindahl::identification {
namespace {

/// More reversals than this are a long record, whose many cycles average the missed extremes.
constexpr std::size_t kMostReversals = 200;
constexpr double kChance = 1e-6;

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The linear least-squares step from `theta` in the free parameters of `layout`, and the residuals
/// that it would leave.
struct LinearStep {
  Eigen::VectorXd step;
  Eigen::VectorXd left;
};

LinearStep StepFrom(const ForceResidual& residual, const ParameterLayout& layout,
                    const std::vector<double>& theta) {
  const auto rows = static_cast<Eigen::Index>(residual.size());
  const auto columns = static_cast<Eigen::Index>(layout.free().size());
  RowMajorMatrix jacobian(rows, columns);
  Eigen::VectorXd values(rows);
  residual.Differentiate(theta, layout.free(), {values.data(), residual.size()},
                         {jacobian.data(), static_cast<std::size_t>(jacobian.size())});
  LinearStep result;
  result.step = jacobian.colPivHouseholderQr().solve(-values);
  result.left = values + jacobian * result.step;
  return result;
}

/// Twice the logarithm of the likelihood ratio of residuals `left` to those with `sum_of_squares`.
double LogLikelihoodGain(double sum_of_squares, const std::vector<double>& left) {
  const ResidualStatistics statistics = DescribeResiduals({&left, 1}, {&left, 1}, 1.0, 0);
  const double mean_square = sum_of_squares / static_cast<double>(left.size());
  return statistics.effective_samples * std::log(mean_square / (statistics.rms * statistics.rms));
}

}  // namespace

std::optional<TurningPointFit> FitTurningPoints(const ScaledRecords& data,
                                                const ForceResidual& residual,
                                                const ParameterLayout& layout, const Solution& best,
                                                const FitOptions& options) {
  std::size_t reversals = 0;
  for (const ScaledRecord& record : data.records) reversals += record.reversals.size();
  const std::size_t parameters = layout.free().size() + reversals;
  if (reversals == 0 || reversals > kMostReversals || 2 * parameters > residual.size()) return {};

  TurningPointFit fit{layout.WithOvershoots(data), {}};
  std::vector<double> theta = best.theta;
  theta.resize(fit.layout.parameters().size(), 0.0);
  const LinearStep linear = StepFrom(residual, fit.layout, theta);
  const double needed = boost::math::quantile(
      boost::math::complement(boost::math::chi_squared(static_cast<double>(reversals)), kChance));
  const std::vector<double> left(linear.left.begin(), linear.left.end());
  if (!(LogLikelihoodGain(best.sum_of_squares, left) > needed)) return {};

  const std::vector<std::size_t>& free = fit.layout.free();
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i] >= layout.parameters().size()) {
      theta[free[i]] = std::max(linear.step[static_cast<Eigen::Index>(i)], 0.0);
    }
  }
  fit.solution = Solve(residual, fit.layout, theta, options);
  std::vector<double> refitted(residual.size());
  residual.Evaluate(fit.solution.theta, refitted);
  const double price = 2 * static_cast<double>(reversals);
  if (!fit.solution.converged ||
      !(LogLikelihoodGain(best.sum_of_squares, refitted) > std::max(price, needed))) {
    return {};
  }
  return fit;
}

}  // namespace mindahl::identification
