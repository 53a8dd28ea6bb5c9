#include "identification/inference/adequacy_test.h"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <utility>

#include "identification/inference/evidence.h"

namespace mindahl::identification {
namespace {

/// Each column of departures is paid for by so many samples, or it is not looked for.
constexpr std::size_t kSamplesAColumn = 8;
/// A column of which less is left beside the parameters is one of theirs.
constexpr double kOwnShare = 0.02;
/// Likewise beside the departures before it.
constexpr double kIndependent = 1e-3;

double PValue(double f, double numerator, double denominator) {
  if (!(f > 0)) return 1.0;
  const boost::math::fisher_f distribution(numerator, std::max(denominator, 1.0));
  return boost::math::cdf(boost::math::complement(distribution, f));
}

void TakeOut(const Eigen::Ref<const Eigen::MatrixXd>& orthonormal, Eigen::VectorXd& column) {
  const Eigen::VectorXd shares = orthonormal.transpose() * column;
  column -= orthonormal * shares;
}

/// Orthonormal columns that with `basis` span what `columns` do.
/// @param own_share  a column of which less is left beside the basis is left out
/// @param kept       written: those that are not
Eigen::MatrixXd Orthonormal(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& columns,
                            double own_share, std::vector<Eigen::Index>& kept) {
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  Eigen::Index count = 0;
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    Eigen::VectorXd column = columns.col(c);
    const double norm = column.norm();
    if (!(norm > 0) || !std::isfinite(norm)) continue;
    column /= norm;
    TakeOut(basis, column);
    if (column.norm() < own_share) continue;
    TakeOut(result.leftCols(count), column);
    const double left = column.norm();
    if (left < kIndependent) continue;
    column /= left;
    TakeOut(basis, column);
    TakeOut(result.leftCols(count), column);
    result.col(count++) = column.normalized();
    kept.push_back(c);
  }
  return result.leftCols(count);
}

Autocorrelation AutocorrelationOf(const ScaledRecords& data, const Eigen::VectorXd& residual) {
  std::vector<std::span<const double>> series;
  std::vector<std::span<const unsigned char>> counts;
  std::size_t begin = 0;
  for (const ScaledRecord& record : data.records) {
    series.emplace_back(residual.data() + begin, record.size());
    counts.emplace_back(record.counts);
    begin += record.size();
  }
  return EstimateAutocorrelation(series, counts);
}

/// Wald's statistic, over their number, of the coefficients of orthonormal columns U in the
/// residuals. Noise counts at least as white: where departures took up what is slow of it, the rest
/// would call what is slow improbable.
/// @param correlated  UᵀRU
double WaldF(const Eigen::VectorXd& coefficients, const Eigen::MatrixXd& correlated,
             double variance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(correlated);
  const Eigen::ArrayXd along = (axes.eigenvectors().transpose() * coefficients).array();
  return (along.square() / axes.eigenvalues().array().max(1.0)).mean() / variance;
}

}  // namespace

AdequacyTest TestAdequacy(const Problem& problem, const Solution& solution, const Noise& noise,
                          const Estimates& estimates, Response& response) {
  AdequacyTest test;
  const Eigen::MatrixXd& jacobian = estimates.jacobian();
  const Eigen::VectorXd& residual = estimates.residual();
  const auto samples = static_cast<double>(problem.data->counted);
  const auto parameters = static_cast<double>(jacobian.cols());
  if (samples <= parameters + 1) return test;
  const std::size_t most =
      (problem.data->counted - problem.parameters.free().size()) / kSamplesAColumn;
  const DepartureColumns departures = ColumnsOfDepartures(problem, solution.theta, response, most);

  std::vector<Eigen::Index> ignored;
  const Eigen::MatrixXd none(jacobian.rows(), 0);
  const Eigen::MatrixXd basis = Orthonormal(none, jacobian, 0.0, ignored);
  std::vector<Eigen::Index> kept;
  const Eigen::MatrixXd all = Orthonormal(basis, departures.columns, kOwnShare, kept);
  const Eigen::VectorXd explained = all.transpose() * residual;
  const Eigen::VectorXd rest = residual - all * explained;
  const Autocorrelation autocorrelation = AutocorrelationOf(*problem.data, rest);

  // Of correlated noise a fit takes up more than its parameters' number.
  Eigen::MatrixXd together(jacobian.rows(), basis.cols() + all.cols());
  together << basis, all;
  const Eigen::MatrixXd product = CorrelatedProduct(*problem.data, autocorrelation, together);
  const double absorbed = std::min(product.trace(), samples / 2);
  const double variance =
      noise.is_known ? noise.variance : rest.squaredNorm() / (samples - absorbed);
  const double effective = samples / std::max(1.0, autocorrelation.SquaredCorrelations());
  const auto columns = static_cast<double>(all.cols());
  test.noise = std::sqrt(variance);
  test.degrees_of_freedom = std::max(1.0, effective - parameters - columns);
  if (all.cols() == 0 || !(variance > 0)) return test;
  const Eigen::MatrixXd own = product.bottomRightCorner(all.cols(), all.cols());
  test.p_value = PValue(WaldF(explained, own, variance), columns, test.degrees_of_freedom);
  test.misfit_over_noise =
      std::sqrt(std::max(0.0, explained.squaredNorm() / variance - own.trace()) / samples);

  const Evidence evidence(problem.data->counted, effective);
  const double before = residual.squaredNorm();
  for (std::size_t d = 0; d < Departures().size(); ++d) {
    std::vector<Eigen::Index> places;
    for (std::size_t c = 0; c < departures.of.size(); ++c) {
      if (departures.of[c] == d) places.push_back(static_cast<Eigen::Index>(c));
    }
    if (places.empty()) continue;
    const Eigen::MatrixXd columns_of_it = departures.columns(Eigen::all, places);
    std::vector<Eigen::Index> used;
    const Eigen::MatrixXd free_of_law = Orthonormal(basis, columns_of_it, kOwnShare, used);
    if (used.empty()) continue;
    const auto count = static_cast<Eigen::Index>(used.size());
    // Model and departure together, scaled to unit columns.
    Eigen::MatrixXd both(jacobian.rows(), jacobian.cols() + count);
    both << jacobian, columns_of_it(Eigen::all, used);
    Eigen::VectorXd norms = both.colwise().norm().transpose();
    for (double& norm : norms) norm = norm > 0 ? norm : 1.0;
    both = both * norms.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd factor =
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(both.transpose() * both)
            .pseudoInverse();
    const Eigen::VectorXd step = -factor * (both.transpose() * residual);
    const Eigen::MatrixXd covariance =
        variance * factor * CorrelatedProduct(*problem.data, autocorrelation, both) * factor;
    const double after = (residual + both * step).squaredNorm();
    DepartureFit fit;
    fit.departure = d;
    const Departure& departure = Departures()[d];
    fit.unit = departures.timed || departure.unit_by_sample.empty() ? departure.unit
                                                                    : departure.unit_by_sample;
    const Eigen::MatrixXd correlated =
        CorrelatedProduct(*problem.data, autocorrelation, free_of_law);
    fit.p_value = PValue(WaldF(free_of_law.transpose() * residual, correlated, variance),
                         static_cast<double>(count), test.degrees_of_freedom);
    fit.delta_aicc = 2.0 * static_cast<double>(count) - evidence.LikelihoodRatio(before, after);
    fit.explains = before > 0 ? 1 - after / before : 0.0;
    const Eigen::Index first = jacobian.cols();
    fit.size =
        step[first] / norms[first] *
        departures
            .unit_of_size[static_cast<std::size_t>(places[static_cast<std::size_t>(used.front())])];
    for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
      fit.step.push_back(step[j] / norms[j]);
      fit.error.push_back(std::sqrt(std::max(covariance(j, j), variance * factor(j, j))) /
                          norms[j]);
    }
    test.fits.push_back(std::move(fit));
  }
  return test;
}

namespace {

/// Place of a parameter among those that are free, their number where it is not.
std::size_t PlaceOf(const Problem& problem, std::size_t parameter) {
  const auto& free = problem.parameters.free();
  return static_cast<std::size_t>(std::ranges::find(free, parameter) - free.begin());
}

}  // namespace

double MoveOf(const Problem& problem, const Solution& solution, const DepartureFit& fit,
              std::size_t parameter, const ParameterEstimate& estimate) {
  const std::size_t place = PlaceOf(problem, parameter);
  if (place == fit.step.size() || !estimate.lower95 || !estimate.upper95) return 0.0;
  const double half = (*estimate.upper95 - *estimate.lower95) / 2;
  const double moved =
      problem.parameters[parameter].ToValue(solution.theta[parameter] + fit.step[place]);
  return half > 0 ? std::abs(moved - estimate.value) / half : 0.0;
}

void WidenByDepartures(const Problem& problem, const Solution& solution,
                       std::span<const DepartureFit> fits, double quantile,
                       std::span<ParameterEstimate> estimates) {
  const auto& reported = problem.parameters.reported();
  for (std::size_t k = 0; k < reported.size(); ++k) {
    const std::size_t p = reported[k];
    const Parameter& parameter = problem.parameters[p];
    ParameterEstimate& estimate = estimates[k];
    const std::size_t place = PlaceOf(problem, p);
    for (const DepartureFit& fit : fits) {
      if (place == fit.step.size()) continue;
      // Beyond a factor of e³ a linear step says only that little is known; short of it, it errs
      // by the like of its square.
      constexpr double kFarthest = 3.0;
      const double step = std::clamp(fit.step[place], -kFarthest, kFarthest);
      const double half =
          quantile * std::min(fit.error[place], kFarthest) + std::min(step * step, kFarthest);
      const double one = parameter.ToValue(solution.theta[p] + step - half);
      const double other = parameter.ToValue(solution.theta[p] + step + half);
      if (estimate.lower95) estimate.lower95 = std::min({*estimate.lower95, one, other});
      if (estimate.upper95) estimate.upper95 = std::max({*estimate.upper95, one, other});
      if (p == kShape && estimate.lower95) estimate.lower95 = std::max(*estimate.lower95, 0.0);
    }
  }
}

}  // namespace mindahl::identification
