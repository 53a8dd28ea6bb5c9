#include "identification/inference/column_test.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "core/probability.h"
#include "identification/dense.h"
#include "identification/inference/noise.h"
#include "identification/intervals.h"
#include "identification/solve/sums.h"

namespace mindahl::identification {

namespace {

/// Least part of a column orthogonal to the law's, below which it is one of theirs.
constexpr double kOwnShare = 0.02;
/// Least part orthogonal to the columns before it.
constexpr double kIndependent = 1e-3;

/// Wald's statistic, over their number, of the coefficients of orthonormal columns U in the
/// residuals. Noise counts at least as white: where the columns took up what is slow of it, the
/// rest would call what is slow improbable.
/// @param correlated  UᵀRU
double WaldF(const Eigen::VectorXd& coefficients, const Eigen::MatrixXd& correlated,
             double variance) {
  const Eigenpairs axes = SymmetricEigenpairs(correlated);
  const Eigen::ArrayXd along = (axes.vectors.transpose() * coefficients).array();
  return (along.square() / axes.values.array().max(1.0)).mean() / variance;
}

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& symmetric) {
  return symmetric.size() == 0 ? symmetric : PseudoInverse(symmetric);
}

std::span<const double> ColumnValues(const Eigen::MatrixXd& matrix, Eigen::Index j) {
  return {matrix.col(j).data(), static_cast<std::size_t>(matrix.rows())};
}

std::span<const double> SpanOf(const Eigen::VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

/// AᵀA
Eigen::MatrixXd ProductsOf(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd products(columns.cols(), columns.cols());
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    for (Eigen::Index k = 0; k <= j; ++k) {
      products(j, k) = products(k, j) = Dot(ColumnValues(columns, j), ColumnValues(columns, k));
    }
  }
  return products;
}

/// Orthonormal columns that span both.
Eigen::MatrixXd OrthonormalOf(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
  Eigen::MatrixXd both(one.rows(), one.cols() + other.cols());
  both << one, other;
  return OrthonormalBasis(both);
}

}  // namespace

ColumnTest::ColumnTest(const Problem& problem, const Noise& noise,
                       const DisplacementEffect& displacement, const Eigen::MatrixXd& law,
                       const Eigen::MatrixXd& others, const Eigen::VectorXd& residual,
                       const ColumnTest* quieter, bool restores)
    : law_(law.cols()),
      samples_(static_cast<double>(problem.data->counted)),
      sum_of_squares_(residual.squaredNorm()) {
  Eigen::MatrixXd columns(law.rows(), law_ + others.cols());
  columns << law, others;
  norms_.resize(columns.cols());
  residual_.resize(columns.cols());
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const double square = Dot(ColumnValues(columns, j), ColumnValues(columns, j));
    const bool is_told = std::isfinite(square) && square > 0;
    norms_[j] = is_told ? std::sqrt(square) : 1.0;
    if (is_told) {
      columns.col(j) *= 1 / norms_[j];
    } else {
      columns.col(j).setZero();  // overflow: not identifiable
    }
    residual_[j] = Dot(ColumnValues(columns, j), SpanOf(residual));
  }
  plain_ = ProductsOf(columns);
  inverse_of_law_ = Inverse(plain_.topLeftCorner(law_, law_));
  shares_ = Product(inverse_of_law_, plain_.topRightCorner(law_, others.cols()));
  free_plain_ = FreedOfLaw(plain_);
  free_residual_ = residual_.tail(others.cols()) - shares_.transpose() * residual_.head(law_);

  std::vector<Eigen::Index> everything(static_cast<std::size_t>(others.cols()));
  std::iota(everything.begin(), everything.end(), Eigen::Index{0});
  all_ = Orthonormal(everything);
  const Eigen::VectorXd explained = all_.transpose() * free_residual_;
  Eigen::VectorXd in_columns(columns.cols());
  in_columns.tail(others.cols()) = all_ * explained;
  in_columns.head(law_) = -shares_ * in_columns.tail(others.cols());
  Eigen::VectorXd rest = residual;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    AddMultiple({rest.data(), problem.size()}, -in_columns[j], ColumnValues(columns, j));
  }
  has_drawn_ = displacement.residuals.size() > 0;
  if (quieter != nullptr) {
    autocorrelation_ = quieter->autocorrelation_;
  } else if (restores) {
    autocorrelation_ = AutocorrelationBeside(
        *problem.data, {rest.data(), problem.size()},
        OrthonormalOf(columns.leftCols(law_), Product(columns.rightCols(others.cols()), all_)));
  } else {
    autocorrelation_ = AutocorrelationOf(*problem.data, {rest.data(), problem.size()});
  }
  is_white_ = autocorrelation_.order == 0 && !has_drawn_;
  correlated_ =
      is_white_ ? plain_
                : CorrelatedProduct(*problem.data, autocorrelation_, noise, displacement, columns);
  if (!is_white_) free_correlated_ = FreedOfLaw(correlated_);

  // A fit absorbs more of correlated noise than the number of its parameters.
  const double by_law = Product(inverse_of_law_, correlated_.topLeftCorner(law_, law_)).trace();
  const double by_others = CorrelationOf(all_).trace();
  const double absorbed = std::min(by_law + by_others, samples_ / 2);
  if (quieter != nullptr) {
    variance_ = quieter->variance_;
  } else {
    variance_ = noise.is_known ? noise.variance : rest.squaredNorm() / (samples_ - absorbed);
  }
  effective_samples_ = samples_ / std::max(1.0, autocorrelation_.SquaredCorrelations());
  degrees_of_freedom_ = std::max(
      1.0, effective_samples_ - static_cast<double>(law_) - static_cast<double>(all_.cols()));
}

/// Returns the products of the other columns, orthogonalised to those of the law.
/// @param products  of A
Eigen::MatrixXd ColumnTest::FreedOfLaw(const Eigen::MatrixXd& products) const {
  const Eigen::Index count = products.cols() - law_;
  const Eigen::MatrixXd mixed = TransposedProduct(shares_, products.topRightCorner(law_, count));
  return products.bottomRightCorner(count, count) - mixed - mixed.transpose() +
         Product(TransposedProduct(shares_, products.topLeftCorner(law_, law_)), shares_);
}

/// Coefficients, in columns freed of the law, of orthonormal ones that span some of them; none
/// where a column has less than kOwnShare of its own.
Eigen::MatrixXd ColumnTest::Orthonormal(std::span<const Eigen::Index> places) const {
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(free_plain_.rows(), static_cast<Eigen::Index>(places.size()));
  Eigen::MatrixXd image = result;  // free_plain·result
  Eigen::Index count = 0;
  for (const Eigen::Index place : places) {
    if (!(free_plain_(place, place) >= kOwnShare * kOwnShare)) continue;
    Eigen::VectorXd v = Eigen::VectorXd::Unit(free_plain_.rows(), place);
    Eigen::VectorXd of_v = free_plain_.col(place);
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

Eigen::MatrixXd ColumnTest::CorrelationOf(const Eigen::MatrixXd& basis) const {
  if (is_white_) return Eigen::MatrixXd::Identity(basis.cols(), basis.cols());
  return Product(TransposedProduct(basis, free_correlated_), basis);
}

ColumnTest::Part ColumnTest::AskBasis(const Eigen::MatrixXd& basis) const {
  Part part{.columns = static_cast<std::size_t>(basis.cols())};
  if (part.columns == 0 || !(variance_ > 0)) return part;
  const Eigen::VectorXd explained = basis.transpose() * free_residual_;
  const Eigen::MatrixXd correlated = CorrelationOf(basis);
  const double f = WaldF(explained, correlated, variance_);
  const double of_noise = variance_ * correlated.trace();
  part.rms = std::sqrt(std::max(0.0, explained.squaredNorm() - of_noise) / samples_);
  // If nothing is explained, or less by rounding, noise alone makes it.
  part.p_value = f > 0 ? PValueOfF(f, static_cast<double>(part.columns), degrees_of_freedom_) : 1.0;
  return part;
}

ColumnTest::Part ColumnTest::Ask(std::span<const Eigen::Index> places) const {
  return AskBasis(Orthonormal(places));
}

double ColumnTest::p_value() const { return AskBasis(all_).p_value; }

double ColumnTest::misfit_over_noise() const {
  const Eigen::VectorXd explained = all_.transpose() * free_residual_;
  const double of_noise = CorrelationOf(all_).trace();
  return std::sqrt(std::max(0.0, explained.squaredNorm() / variance_ - of_noise) / samples_);
}

LinearStep ColumnTest::Step(std::span<const Eigen::Index> places) const {
  std::vector<Eigen::Index> both(static_cast<std::size_t>(law_));
  std::iota(both.begin(), both.end(), Eigen::Index{0});
  for (const Eigen::Index place : places) both.push_back(law_ + place);
  const Eigen::MatrixXd products = plain_(both, both);
  const Eigen::MatrixXd factor = Inverse(products);
  const Eigen::VectorXd step = -factor * residual_(both);
  const Eigen::MatrixXd correlated = correlated_(both, both);
  const Eigen::MatrixXd covariance = Product(Product(variance_ * factor, correlated), factor);
  const double gain = -step.dot(products * step) - 2 * step.dot(residual_(both));
  const auto error = [&](Eigen::Index j) {
    return std::sqrt(std::max(covariance(j, j), variance_ * factor(j, j)));
  };
  LinearStep result;
  result.explains = sum_of_squares_ > 0 ? std::clamp(gain / sum_of_squares_, 0.0, 1.0) : 0.0;
  const double first = norms_[law_ + places[0]];
  result.size = step[law_] / first;
  result.size_error = error(law_) / first;
  for (Eigen::Index j = 0; j < law_; ++j) {
    result.step.push_back(step[j] / norms_[j]);
    result.error.push_back(error(j) / norms_[j]);
  }
  return result;
}

namespace {

/// Returns the Jacobian without the columns of parameters at a bound, the user's or the program's:
/// what these would still explain, they may not.
Eigen::MatrixXd WithoutBounds(const Problem& problem, const Solution& solution,
                              Eigen::MatrixXd jacobian) {
  const auto& free = problem.parameters.free();
  for (std::size_t j = 0; j < free.size(); ++j) {
    if (solution.side[free[j]] != BoundSide::kInside) {
      jacobian.col(static_cast<Eigen::Index>(j)).setZero();
    }
  }
  return jacobian;
}

/// Tests the columns of all omitted terms together, and those of each.
AdequacyTest Ask(const Problem& problem, const ColumnTest& columns,
                 const DepartureColumns& departures, double before, const Thresholds& thresholds) {
  AdequacyTest test;
  test.noise = std::sqrt(columns.variance());
  test.degrees_of_freedom = columns.degrees_of_freedom();
  if (!columns.can_tell()) return test;
  test.p_value = columns.p_value();
  test.misfit_over_noise = columns.misfit_over_noise();
  test.effective_samples = columns.effective_samples();

  const Evidence evidence(problem.data->counted, columns.effective_samples());
  for (std::size_t group = 0; group < departures.groups; ++group) {
    std::vector<Eigen::Index> places;
    for (std::size_t c = 0; c < departures.group.size(); ++c) {
      if (departures.group[c] == group) places.push_back(static_cast<Eigen::Index>(c));
    }
    const ColumnTest::Part part = columns.Ask(places);
    if (part.columns == 0) continue;
    const auto first = static_cast<std::size_t>(places[0]);
    DepartureFit fit;
    fit.departure = departures.of[first];
    const std::size_t plain = departures.of.size() - departures.covariates.size();
    if (first >= plain) fit.covariate = departures.covariates[first - plain];
    fit.p_value = part.p_value;
    if (fit.p_value < thresholds.cause) {
      LinearStep step = columns.Step(places);
      fit.explains = step.explains;
      fit.size = step.size * departures.unit_of_size[first];
      fit.size_p_value = fit.p_value;
      if (places.size() > 1) {
        const double errors = step.size_error > 0 ? step.size / step.size_error : 0.0;
        fit.size_p_value = PValueOfF(errors * errors, columns.degrees_of_freedom());
      }
      fit.step = std::move(step.step);
      fit.error = std::move(step.error);
      const Departure& departure = Departures()[fit.departure];
      fit.unit = departures.timed || departure.unit_by_sample.empty() ? departure.unit
                                                                      : departure.unit_by_sample;
      const double after = before * (1 - fit.explains);
      fit.delta_aicc =
          2 * static_cast<double>(part.columns) - evidence.LikelihoodRatio(before, after);
    }
    test.fits.push_back(std::move(fit));
  }
  return test;
}

/// True if noise makes what was found rarely, and not so rarely that what the columns took up of
/// its autocorrelation could not matter.
bool IsOnTheEdge(const AdequacyTest& test) {
  constexpr double kClear = 1e-12;
  constexpr double kRare = 0.05;
  double least = test.p_value;
  for (const DepartureFit& fit : test.fits) {
    least = std::min(least, static_cast<double>(test.fits.size()) * fit.p_value);
  }
  return 2 * least < kRare && least > kClear;
}

}  // namespace

AdequacyTest TestAdequacy(const FittedProblem& fitted, const DisplacementEffect& displacement,
                          const Thresholds& thresholds, Response& response) {
  const auto& [problem, solution, noise, estimates] = fitted;
  const Eigen::MatrixXd jacobian = WithoutBounds(problem, solution, estimates.jacobian());
  const Eigen::VectorXd& residual = estimates.residual();
  const auto samples = static_cast<double>(problem.data->counted);
  if (samples <= static_cast<double>(jacobian.cols()) + 1) return {};
  const std::size_t most =
      (problem.data->counted - problem.parameters.free().size()) / kSamplesAColumn;
  const DepartureColumns departures = ColumnsOfDepartures(problem, solution.theta, response, most);
  const double before = residual.squaredNorm();
  const ColumnTest columns(problem, noise, displacement, jacobian, departures.columns, residual);
  AdequacyTest test = Ask(problem, columns, departures, before, thresholds);
  if (!columns.is_correlated() || !IsOnTheEdge(test)) return test;
  // So many columns take up most of what is slow in the noise, and what they left of it would call
  // the slow improbable.
  const ColumnTest restored(problem, noise, displacement, jacobian, departures.columns, residual,
                            nullptr, /*restores=*/true);
  return Ask(problem, restored, departures, before, thresholds);
}

double MoveOf(const Problem& problem, const Solution& solution, const DepartureFit& fit,
              std::size_t parameter, const ParameterEstimate& estimate) {
  const std::size_t place = problem.parameters.PlaceAmongFree(parameter);
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
    const std::size_t place = problem.parameters.PlaceAmongFree(p);
    for (const DepartureFit& fit : fits) {
      if (place == fit.step.size()) continue;
      const double step = std::clamp(fit.step[place], -kFarthestStep, kFarthestStep);
      // σ and Tc are in proportion to the force; parts of the record may have their own.
      const bool is_of_force = p == kStiffness || p == kSlipForce;
      const double apart = Departures()[fit.departure].apart * std::abs(fit.size);
      const double half = quantile * std::min(fit.error[place], kFarthestStep) +
                          std::min(step * step, kFarthestStep) +  // by which a linear step errs
                          (is_of_force ? std::min(apart, kFarthestStep) : 0.0);
      const double one = parameter.ToValue(solution.theta[p] + step - half);
      const double other = parameter.ToValue(solution.theta[p] + step + half);
      const auto [lower, upper] = std::minmax(one, other);
      Include(estimate, {.source = IntervalSource::kOmittedTerms,
                         .lower = p == kShape ? std::max(lower, 0.0) : lower,
                         .upper = upper});
    }
  }
}

}  // namespace mindahl::identification
