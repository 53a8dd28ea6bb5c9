#include "identification/inference/estimates.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/probability.h"

namespace mindahl::identification {

namespace {

ParameterStatus StatusOf(const Parameter& parameter, double theta) {
  if (parameter.fixed) return ParameterStatus::kFixed;
  const BoundSide side = SideOf(parameter, theta);
  if (side == BoundSide::kInside) return ParameterStatus::kFree;
  const bool is_lower = (side == BoundSide::kLower) == (parameter.scale > 0);
  return is_lower ? ParameterStatus::kAtLowerBound : ParameterStatus::kAtUpperBound;
}

std::optional<double> Finite(std::optional<double> end) {
  return end && std::isfinite(*end) ? end : std::nullopt;
}

}  // namespace

std::vector<ParameterEstimate> ValuesOf(const Problem& problem, const Solution& solution) {
  const Parameters& parameters = problem.parameters;
  std::vector<ParameterEstimate> values;
  for (const std::size_t p : parameters.reported()) {
    ParameterEstimate& estimate = values.emplace_back();
    estimate.name = parameters.NameOf(p);
    estimate.unit = parameters.UnitOf(p);
    estimate.value = parameters[p].ToValue(solution.theta[p]);
    estimate.status = StatusOf(parameters[p], solution.theta[p]);
  }
  return values;
}

Estimates::Estimates(const Problem& problem, const Solution& solution, const Noise& noise,
                     const FitOptions& options, Linearization at)
    : problem_(problem),
      solution_(solution),
      noise_(noise),
      options_(options),
      quantile_(StudentQuantile(noise.degrees_of_freedom(problem.parameters.free().size()),
                                options.confidence)),
      variance_(noise.variance * noise.repeating),
      at_(std::move(at)) {
  const std::vector<std::size_t>& free = problem.parameters.free();
  if (free.empty()) return;
  // A prior is one more reading, weighted by the noise of the others.
  Eigen::VectorXd weights(std::ssize(free));
  std::ranges::transform(free, weights.begin(),
                         [&](std::size_t p) { return problem.parameters[p].prior_root_weight; });
  const Eigen::MatrixXd priors = weights.asDiagonal();
  // Singular values below this fraction of the largest are rounding of unit columns.
  constexpr double kRankTolerance = 1e-11;
  // A parameter with more than this component in a direction without effect is not determined.
  constexpr double kOpenComponent = 1e-3;
  const Eigen::Index size = priors.cols();
  // R of J = QR has its singular values and is small, however long the record.
  const Eigen::HouseholderQR<Eigen::MatrixXd> factors(at_.jacobian);
  const Eigen::MatrixXd triangle = factors.matrixQR().topRows(size).triangularView<Eigen::Upper>();
  Eigen::MatrixXd rows(2 * size, size);
  rows << triangle, priors;
  // Columns are scaled to one, whatever their units.
  const Eigen::VectorXd scale =
      rows.colwise().norm().unaryExpr([](double norm) { return norm == 0 ? 1.0 : 1 / norm; });
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows * scale.asDiagonal(), Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.singularValues();
  const Eigen::Index rank = (values.array() > kRankTolerance * values[0]).count();
  open_directions_ = static_cast<std::size_t>(size - rank);
  const Eigen::ArrayXXd open = svd.matrixV().rightCols(size - rank).cwiseAbs();
  determined_ = (open <= kOpenComponent).rowwise().all();
  if (rank == 0) return;  // nothing is determined
  // Directions H with an effect: a column each, in units of θ.
  const Eigen::ArrayXXd of_unit_columns = scale.asDiagonal() * svd.matrixV().leftCols(rank);
  const Eigen::MatrixXd directions =
      of_unit_columns.rowwise() / values.head(rank).transpose().array();
  // JH has orthonormal columns, so that the noise makes a product of order one: between two
  // inverses of an ill-conditioned JᵀJ its rounding errors would outgrow it.
  Eigen::MatrixXd product =
      noise.Product(problem.data->records, noise.autocorrelation, at_.jacobian * directions);
  // A fit absorbs more of correlated residuals than the number of its parameters, and leaves less
  // than the noise's variance; beyond most_absorbed no more is corrected.
  if (!noise.is_known && noise.drawn.size() == 0) {
    const auto count = static_cast<double>(noise.samples);
    const auto parameters = static_cast<double>(free.size());
    const double absorbed = std::min(product.trace(), options.thresholds.most_absorbed * count);
    if (absorbed > parameters) variance_ *= (count - parameters) / (count - absorbed);
  }
  // Its own uncertainty is what is given, whatever the residuals are.
  const Eigen::MatrixXd of_priors = problem.data->prior_noise * priors * directions;
  product += of_priors.transpose() * of_priors / variance_;
  // Without what rounding leaves below zero.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> pairs(product);
  const Eigen::MatrixXd root = directions * pairs.eigenvectors() *
                               pairs.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  // Element by element: symmetric to the last bit.
  factor_ = root.lazyProduct(root.transpose());
  white_factor_ = directions.lazyProduct(directions.transpose());
}

Linearization Estimates::WithPriors() const {
  Linearization at = at_;
  const std::vector<std::size_t>& free = problem_.parameters.free();
  for (std::size_t j = 0; j < free.size(); ++j) {
    const Parameter& parameter = problem_.parameters[free[j]];
    if (!parameter.has_prior()) continue;
    const Eigen::Index row = at.residual.size();
    at.jacobian.conservativeResizeLike(Eigen::MatrixXd::Zero(row + 1, at.jacobian.cols()));
    at.jacobian(row, static_cast<Eigen::Index>(j)) = parameter.prior_root_weight;
    at.residual.conservativeResize(row + 1);
    at.residual[row] =
        parameter.prior_root_weight * (solution_.theta[free[j]] - parameter.prior_theta);
  }
  return at;
}

std::optional<Eigen::Index> Estimates::PlaceOf(std::size_t parameter) const {
  const std::vector<std::size_t>& free = problem_.parameters.free();
  const auto place = std::ranges::find(free, parameter) - free.begin();
  if (place == std::ssize(free) || !determined_[place]) return {};
  return place;
}

double Estimates::ErrorOfTheta(std::size_t parameter) const {
  if (problem_.parameters[parameter].fixed) return 0.0;
  const std::optional<Eigen::Index> place = PlaceOf(parameter);
  if (!place) return std::numeric_limits<double>::infinity();
  return std::sqrt(factor_(*place, *place) * variance_);
}

std::vector<double> Estimates::Beside(std::size_t parameter, double step) const {
  std::vector<double> theta = solution_.theta;
  theta[parameter] += step;
  const std::optional<Eigen::Index> place = PlaceOf(parameter);
  for (Eigen::Index j = 0; place && j < white_factor_.rows(); ++j) {
    const double slope = white_factor_(j, *place) / white_factor_(*place, *place);
    if (j != *place) theta[problem_.parameters.free()[static_cast<std::size_t>(j)]] += step * slope;
  }
  return theta;
}

double Estimates::SamplesOf(std::size_t parameter) const {
  const std::optional<Eigen::Index> place = PlaceOf(parameter);
  if (!place) return 0.0;
  const Eigen::ArrayXd squares = (at_.jacobian * white_factor_.col(*place)).array().square();
  return squares.sum() * squares.sum() / squares.square().sum();
}

void Estimates::Fill(std::size_t p, ParameterEstimate& estimate) const {
  const Parameter& parameter = problem_.parameters[p];
  const double theta = solution_.theta[p];
  const double error = ErrorOfTheta(p);
  SetInterval(estimate, {});
  if (parameter.fixed || !std::isfinite(error)) return;
  const BoundSide side = SideOf(parameter, theta);
  const bool is_inside = side == BoundSide::kInside;
  // At a bound half the normal law lies beyond it.
  const double half = (is_inside ? quantile_ : NormalQuantile(options_.confidence)) * error;
  constexpr double kBeyond = std::numeric_limits<double>::infinity();
  const double slope = parameter.term->positive ? estimate.value : std::abs(parameter.scale);
  if (is_inside) estimate.standard_error = slope * error;
  SetInterval(estimate,
              EndsWithinBounds(parameter, side == BoundSide::kLower ? -kBeyond : theta - half,
                               side == BoundSide::kUpper ? kBeyond : theta + half));
}

double Estimates::Correlation(std::size_t row, std::size_t column) const {
  const std::optional<Eigen::Index> i = PlaceOf(row);
  const std::optional<Eigen::Index> j = PlaceOf(column);
  if (!i || !j) return std::numeric_limits<double>::quiet_NaN();
  if (i == j) return 1.0;
  // A value falls where θ grows if its scale is negative.
  const double scales = problem_.parameters[row].scale * problem_.parameters[column].scale;
  const double cosine = factor_(*i, *j) / std::sqrt(factor_(*i, *i) * factor_(*j, *j));
  return std::copysign(1.0, scales) * std::clamp(cosine, -1.0, 1.0);  // but for rounding
}

double Estimates::FStatistic(std::size_t parameter, double sum_of_squares) const {
  const double rise = std::max(sum_of_squares - solution_.sum_of_squares, 0.0);
  const std::optional<Eigen::Index> place = PlaceOf(parameter);
  const double variance = place ? variance_ * factor_(*place, *place) : 0.0;
  // A correlation that is estimated from a handful of residuals may leave no variance at all.
  if (!(variance > 0)) return rise / noise_.variance;
  return rise * white_factor_(*place, *place) / variance;
}

std::optional<double> ValueAtBound(const Parameter& parameter, BoundSide side) {
  if (IsSearchLimit(parameter, side)) return std::nullopt;
  return parameter.ToValue(parameter.BoundOn(side));
}

Ends EndsWithinBounds(const Parameter& parameter, double from, double to) {
  Ends ends{.lower = from < parameter.lower ? ValueAtBound(parameter, BoundSide::kLower)
                                            : parameter.ToValue(from),
            .upper = to > parameter.upper ? ValueAtBound(parameter, BoundSide::kUpper)
                                          : parameter.ToValue(to)};
  if (parameter.scale < 0) std::swap(ends.lower, ends.upper);
  return ends;
}

void SetInterval(ParameterEstimate& estimate, Ends ends) {
  estimate.lower95 = Finite(ends.lower);
  estimate.upper95 = Finite(ends.upper);
  if (estimate.lower95 && estimate.upper95) return;
  estimate.standard_error.reset();
  estimate.includes_discrepancy = false;
}

void Include(ParameterEstimate& estimate, Ends ends) {
  // An empty end is less than any other; of a NaN std::min and std::max return the first argument.
  estimate.lower95 = Finite(std::min(ends.lower, estimate.lower95));
  estimate.upper95 = ends.upper && estimate.upper95 ? Finite(std::max(ends.upper, estimate.upper95))
                                                    : std::nullopt;
}

}  // namespace mindahl::identification
