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
    columns *= norms.cwiseInverse().asDiagonal();
    plain = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
    plain.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
    plain.triangularView<Eigen::StrictlyUpper>() = plain.transpose();
    residual = columns.transpose() * residuals;
    inverse_of_law = Inverse(plain.topLeftCorner(law, law));
    shares = inverse_of_law * plain.topRightCorner(law, departures.cols());
    free_plain = FreedOfLaw(plain);
    free_residual = residual.tail(departures.cols()) - shares.transpose() * residual.head(law);
  }

  /// Once R is known: AᵀRA.
  void Correlate(Eigen::MatrixXd products) {
    correlated = std::move(products);
    free_correlated = FreedOfLaw(correlated);
  }

  /// Of the departures, each less what the law has of it.
  /// @param products  of A
  [[nodiscard]] Eigen::MatrixXd FreedOfLaw(const Eigen::MatrixXd& products) const {
    const Eigen::Index count = columns.cols() - law;
    const Eigen::MatrixXd mixed = shares.transpose() * products.topRightCorner(law, count);
    return products.bottomRightCorner(count, count) - mixed - mixed.transpose() +
           shares.transpose() * products.topLeftCorner(law, law) * shares;
  }

  /// Coefficients, in departures freed of the law, of orthonormal columns that span some of them;
  /// none where a departure has less than kOwnShare of its own.
  [[nodiscard]] Eigen::MatrixXd Orthonormal(std::span<const Eigen::Index> places) const {
    Eigen::MatrixXd result =
        Eigen::MatrixXd::Zero(free_plain.rows(), static_cast<Eigen::Index>(places.size()));
    Eigen::MatrixXd image = result;  // free_plain·result
    Eigen::Index count = 0;
    for (const Eigen::Index place : places) {
      if (!(free_plain(place, place) >= kOwnShare * kOwnShare)) continue;
      Eigen::VectorXd v = Eigen::VectorXd::Unit(free_plain.rows(), place);
      Eigen::VectorXd of_v = free_plain.col(place);
      const auto take_out = [&] {
        const Eigen::VectorXd parts = result.leftCols(count).transpose() * of_v;
        v.noalias() -= result.leftCols(count) * parts;
        of_v.noalias() -= image.leftCols(count) * parts;
      };
      take_out();
      const double left = v.dot(of_v);
      if (!(left >= kIndependent * kIndependent)) continue;
      v /= std::sqrt(left);
      of_v /= std::sqrt(left);
      take_out();
      const double norm = std::sqrt(v.dot(of_v));
      result.col(count) = v / norm;
      image.col(count++) = of_v / norm;
    }
    return result.leftCols(count);
  }

  /// Fills in the linear step that lets some departures in: what it explains, its first size, and
  /// the law's part of it.
  void Step(std::span<const Eigen::Index> places, double variance, DepartureFit& fit) const {
    std::vector<Eigen::Index> both;
    for (Eigen::Index j = 0; j < law; ++j) both.push_back(j);
    for (const Eigen::Index place : places) both.push_back(law + place);
    const Eigen::MatrixXd products = plain(both, both);
    const Eigen::MatrixXd factor = Inverse(products);
    const Eigen::VectorXd step = -factor * residual(both);
    const Eigen::MatrixXd covariance = variance * factor * correlated(both, both) * factor;
    const double gain = -step.dot(products * step) - 2 * step.dot(residual(both));
    fit.explains = sum_of_squares > 0 ? std::clamp(gain / sum_of_squares, 0.0, 1.0) : 0.0;
    fit.size = step[law] / norms[law + places[0]];
    for (Eigen::Index j = 0; j < law; ++j) {
      fit.step.push_back(step[j] / norms[j]);
      fit.error.push_back(std::sqrt(std::max(covariance(j, j), variance * factor(j, j))) /
                          norms[j]);
    }
  }

  Eigen::Index law;
  double sum_of_squares;
  Eigen::MatrixXd columns;  // A
  Eigen::VectorXd norms;
  Eigen::MatrixXd plain;       // AᵀA
  Eigen::MatrixXd correlated;  // AᵀRA
  Eigen::VectorXd residual;    // Aᵀr
  Eigen::MatrixXd inverse_of_law;
  Eigen::MatrixXd shares;           // of the law's columns in each departure
  Eigen::MatrixXd free_plain;       // the same products of the departures freed of the law
  Eigen::MatrixXd free_correlated;  //
  Eigen::VectorXd free_residual;    //
};

/// The Jacobian without the columns of parameters at a bound: what these would still explain, they
/// may not.
Eigen::MatrixXd WithoutBounds(const Problem& problem, const Solution& solution,
                              Eigen::MatrixXd jacobian) {
  const auto& free = problem.parameters.free();
  for (std::size_t j = 0; j < free.size(); ++j) {
    const Parameter& parameter = problem.parameters[free[j]];
    if (parameter.bounded_by_user && solution.side[free[j]] != BoundSide::kInside) {
      jacobian.col(static_cast<Eigen::Index>(j)).setZero();
    }
  }
  return jacobian;
}

/// AᵀRA
Eigen::MatrixXd CorrelationOf(const ScaledRecords& data, const Noise& noise,
                              const Autocorrelation& autocorrelation,
                              const DisplacementEffect& displacement, const Products& products) {
  if (displacement.residuals.size() > 0) {
    return CorrelatedProduct(data, autocorrelation, noise, displacement, products.columns);
  }
  return autocorrelation.order == 0 ? products.plain
                                    : CorrelatedProduct(data, autocorrelation, products.columns);
}

}  // namespace

AdequacyTest TestAdequacy(const Problem& problem, const Solution& solution, const Noise& noise,
                          const DisplacementEffect& displacement, const Estimates& estimates,
                          const Thresholds& thresholds, Response& response) {
  AdequacyTest test;
  const Eigen::MatrixXd jacobian = WithoutBounds(problem, solution, estimates.jacobian());
  const Eigen::VectorXd& residual = estimates.residual();
  const auto samples = static_cast<double>(problem.data->counted);
  const auto parameters = static_cast<double>(jacobian.cols());
  if (samples <= parameters + 1) return test;
  const std::size_t most =
      (problem.data->counted - problem.parameters.free().size()) / kSamplesAColumn;
  const DepartureColumns departures = ColumnsOfDepartures(problem, solution.theta, response, most);

  Products products(jacobian, departures.columns, residual);
  std::vector<Eigen::Index> everything(departures.of.size());
  std::iota(everything.begin(), everything.end(), Eigen::Index{0});
  const Eigen::MatrixXd all = products.Orthonormal(everything);
  const Eigen::VectorXd explained = all.transpose() * products.free_residual;
  const Eigen::Index law = products.law;
  Eigen::VectorXd in_columns(products.columns.cols());
  in_columns.tail(all.rows()) = all * explained;
  in_columns.head(law) = -products.shares * in_columns.tail(all.rows());
  const Eigen::VectorXd rest = residual - products.columns * in_columns;
  const Autocorrelation autocorrelation =
      AutocorrelationOf(*problem.data, {rest.data(), problem.size()});
  products.Correlate(CorrelationOf(*problem.data, noise, autocorrelation, displacement, products));
  const Eigen::MatrixXd own = all.transpose() * products.free_correlated * all;

  // Of correlated noise a fit takes up more than its parameters' number.
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
  test.effective_samples = effective;
  for (std::size_t group = 0; group < departures.groups; ++group) {
    std::vector<Eigen::Index> places;
    for (std::size_t c = 0; c < departures.group.size(); ++c) {
      if (departures.group[c] == group) places.push_back(static_cast<Eigen::Index>(c));
    }
    const Eigen::MatrixXd basis = products.Orthonormal(places);
    if (basis.cols() == 0) continue;
    const auto count = static_cast<double>(basis.cols());
    const auto first = static_cast<std::size_t>(places[0]);
    DepartureFit fit;
    fit.departure = departures.of[first];
    const std::size_t plain = departures.of.size() - departures.covariates.size();
    if (first >= plain) fit.covariate = departures.covariates[first - plain];
    const Eigen::MatrixXd correlated = basis.transpose() * products.free_correlated * basis;
    const Eigen::VectorXd in_residual = basis.transpose() * products.free_residual;
    fit.p_value =
        PValueOf(WaldF(in_residual, correlated, variance), count, test.degrees_of_freedom);
    if (fit.p_value < thresholds.cause) {
      products.Step(places, variance, fit);
      const Departure& departure = Departures()[fit.departure];
      fit.unit = departures.timed || departure.unit_by_sample.empty() ? departure.unit
                                                                      : departure.unit_by_sample;
      fit.size *= departures.unit_of_size[first];
      const double after = before * (1 - fit.explains);
      fit.delta_aicc = 2 * count - evidence.LikelihoodRatio(before, after);
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
      // σ and Tc are in proportion to the force; parts of the record may have their own.
      const bool is_of_force = p == kStiffness || p == kSlipForce;
      const double apart = Departures()[fit.departure].apart * std::abs(fit.size);
      const double half = quantile * std::min(fit.error[place], kFarthest) +
                          std::min(step * step, kFarthest) +
                          (is_of_force ? std::min(apart, kFarthest) : 0.0);
      const double one = parameter.ToValue(solution.theta[p] + step - half);
      const double other = parameter.ToValue(solution.theta[p] + step + half);
      if (estimate.lower95) estimate.lower95 = std::min({*estimate.lower95, one, other});
      if (estimate.upper95) estimate.upper95 = std::max({*estimate.upper95, one, other});
      if (p == kShape && estimate.lower95) estimate.lower95 = std::max(*estimate.lower95, 0.0);
    }
  }
}

}  // namespace mindahl::identification
