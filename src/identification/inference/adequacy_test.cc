#include "identification/inference/adequacy_test.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
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

/// Where nothing is explained, by rounding less, noise alone makes it.
double PValueOf(double f, double columns, double degrees_of_freedom) {
  return f > 0 ? PValueOfF(f, columns, degrees_of_freedom) : 1.0;
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

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& symmetric) {
  if (symmetric.size() == 0) return symmetric;
  return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(symmetric).pseudoInverse();
}

/// The columns A of law and departures, of unit norm, and their products with each other and with
/// the residuals: all that any question below asks for, whatever the number of samples.
struct Products {
  Products(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& departures,
           const Eigen::VectorXd& residuals)
      : law(jacobian.cols()),
        sum_of_squares(residuals.squaredNorm()),
        columns(jacobian.rows(), law + departures.cols()) {
    columns << jacobian, departures;
    for (auto column : columns.colwise()) {
      if (!column.allFinite()) column.setZero();  // overflow: nothing to be told
    }
    norms = columns.colwise().norm().transpose();
    for (double& norm : norms) norm = norm > 0 ? norm : 1.0;
    columns = columns * norms.cwiseInverse().asDiagonal();
    plain = columns.transpose() * columns;
    residual = columns.transpose() * residuals;
    inverse_of_law = Inverse(plain.topLeftCorner(law, law));
  }

  /// Coefficients in A of orthonormal columns that span what some departures have beside the law;
  /// none where that is less than kOwnShare.
  [[nodiscard]] Eigen::MatrixXd FreeOfLaw(std::span<const Eigen::Index> places) const {
    Eigen::MatrixXd result(plain.rows(), static_cast<Eigen::Index>(places.size()));
    Eigen::Index count = 0;
    const auto norm = [&](const Eigen::VectorXd& v) {
      return std::sqrt(std::max(0.0, v.dot(plain * v)));
    };
    const auto take_out = [&](Eigen::VectorXd& v) {
      const Eigen::VectorXd shares = result.leftCols(count).transpose() * (plain * v);
      v -= result.leftCols(count) * shares;
    };
    for (const Eigen::Index place : places) {
      Eigen::VectorXd v = Eigen::VectorXd::Unit(plain.rows(), place);
      v.head(law) = -inverse_of_law * plain.col(place).head(law);
      if (!(norm(v) >= kOwnShare)) continue;
      take_out(v);
      if (!(norm(v) >= kIndependent)) continue;
      v /= norm(v);
      take_out(v);
      result.col(count++) = v / norm(v);
    }
    return result.leftCols(count);
  }

  /// The linear step that lets some departures in: what it explains, its first size, and the law's
  /// part of it.
  [[nodiscard]] DepartureFit Step(std::span<const Eigen::Index> places, double variance) const {
    std::vector<Eigen::Index> both;
    for (Eigen::Index j = 0; j < law; ++j) both.push_back(j);
    both.insert(both.end(), places.begin(), places.end());
    const Eigen::MatrixXd products = plain(both, both);
    const Eigen::MatrixXd factor = Inverse(products);
    const Eigen::VectorXd step = -factor * residual(both);
    const Eigen::MatrixXd covariance = variance * factor * correlated(both, both) * factor;
    DepartureFit fit;
    const double gain = -step.dot(products * step) - 2 * step.dot(residual(both));
    fit.explains = sum_of_squares > 0 ? std::clamp(gain / sum_of_squares, 0.0, 1.0) : 0.0;
    fit.size = step[law] / norms[places[0]];
    for (Eigen::Index j = 0; j < law; ++j) {
      fit.step.push_back(step[j] / norms[j]);
      fit.error.push_back(std::sqrt(std::max(covariance(j, j), variance * factor(j, j))) /
                          norms[j]);
    }
    return fit;
  }

  Eigen::Index law;
  double sum_of_squares;
  Eigen::MatrixXd columns;  // A
  Eigen::VectorXd norms;
  Eigen::MatrixXd plain;       // AᵀA
  Eigen::MatrixXd correlated;  // AᵀRA, once R is known
  Eigen::VectorXd residual;    // Aᵀr
  Eigen::MatrixXd inverse_of_law;
};

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

  Products products(jacobian, departures.columns, residual);
  std::vector<Eigen::Index> everything(departures.of.size());
  std::iota(everything.begin(), everything.end(), jacobian.cols());
  const Eigen::MatrixXd all = products.FreeOfLaw(everything);
  const Eigen::VectorXd explained = all.transpose() * products.residual;
  const Eigen::VectorXd rest = residual - products.columns * (all * explained);
  const Autocorrelation autocorrelation =
      AutocorrelationOf(*problem.data, {rest.data(), problem.size()});
  products.correlated = CorrelatedProduct(*problem.data, autocorrelation, products.columns);
  const Eigen::MatrixXd own = all.transpose() * products.correlated * all;

  // Of correlated noise a fit takes up more than its parameters' number.
  const Eigen::Index law = products.law;
  const double by_law =
      (products.inverse_of_law * products.correlated.topLeftCorner(law, law)).trace();
  const double absorbed = std::min(by_law + own.trace(), samples / 2);
  const double variance =
      noise.is_known ? noise.variance : rest.squaredNorm() / (samples - absorbed);
  const double effective = samples / std::max(1.0, autocorrelation.SquaredCorrelations());
  const auto columns = static_cast<double>(all.cols());
  test.noise = std::sqrt(variance);
  test.degrees_of_freedom = std::max(1.0, effective - parameters - columns);
  if (all.cols() == 0 || !(variance > 0)) return test;
  test.p_value = PValueOf(WaldF(explained, own, variance), columns, test.degrees_of_freedom);
  test.misfit_over_noise =
      std::sqrt(std::max(0.0, explained.squaredNorm() / variance - own.trace()) / samples);

  const Evidence evidence(problem.data->counted, effective);
  const double before = residual.squaredNorm();
  for (std::size_t d = 0; d < Departures().size(); ++d) {
    std::vector<Eigen::Index> places;
    for (std::size_t c = 0; c < departures.of.size(); ++c) {
      if (departures.of[c] == d) places.push_back(jacobian.cols() + static_cast<Eigen::Index>(c));
    }
    const Eigen::MatrixXd free_of_law = products.FreeOfLaw(places);
    if (free_of_law.cols() == 0) continue;
    const auto count = static_cast<double>(free_of_law.cols());
    DepartureFit fit = products.Step(places, variance);
    fit.departure = d;
    const Departure& departure = Departures()[d];
    fit.unit = departures.timed || departure.unit_by_sample.empty() ? departure.unit
                                                                    : departure.unit_by_sample;
    fit.size *= departures.unit_of_size[static_cast<std::size_t>(places[0] - jacobian.cols())];
    const Eigen::MatrixXd correlated = free_of_law.transpose() * products.correlated * free_of_law;
    const Eigen::VectorXd in_residual = free_of_law.transpose() * products.residual;
    fit.p_value =
        PValueOf(WaldF(in_residual, correlated, variance), count, test.degrees_of_freedom);
    const double after = before * (1 - fit.explains);
    fit.delta_aicc = 2 * count - evidence.LikelihoodRatio(before, after);
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
