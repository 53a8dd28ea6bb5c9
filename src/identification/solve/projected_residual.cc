#include "identification/solve/projected_residual.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace mindahl::identification {

// JᵀJ of unit columns = PᵀLDLᵀP; the rows are √D·Lᵀ·P, and those of the residual √D⁻¹·L⁻¹·P·Jᵀr.
CompressedResidual::CompressedResidual(const Eigen::MatrixXd& normal,
                                       const Eigen::VectorXd& gradient, double cost,
                                       std::span<const unsigned char> frozen) {
  // Pivots of unit columns below it are rounding: the direction has no effect.
  constexpr double kNoEffect = 1e-15;
  const Eigen::Index count = gradient.size();
  Eigen::VectorXd norms(count);
  Eigen::VectorXd slopes = gradient;
  Eigen::MatrixXd correlation = normal;
  for (Eigen::Index j = 0; j < count; ++j) {
    const bool is_frozen = !frozen.empty() && frozen[static_cast<std::size_t>(j)] != 0;
    norms[j] = !is_frozen && normal(j, j) > 0 ? std::sqrt(normal(j, j)) : 0.0;
    const double inverse = norms[j] > 0 ? 1 / norms[j] : 0.0;
    slopes[j] *= inverse;
    correlation.row(j) *= inverse;
    correlation.col(j) *= inverse;
  }
  const Eigen::LDLT<Eigen::MatrixXd> factors(correlation);
  const Eigen::VectorXd pivots = factors.vectorD();
  const Eigen::PermutationMatrix<Eigen::Dynamic> permutation(factors.transpositionsP());
  Eigen::VectorXd explained = permutation * slopes;
  factors.matrixL().solveInPlace(explained);
  const Eigen::MatrixXd scales = norms.asDiagonal();
  const Eigen::MatrixXd permuted = permutation * scales;
  jacobian.setZero(count + 1, count);
  jacobian.topRows(count) = factors.matrixU() * permuted;
  residual.setZero(count + 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double root = pivots[k] > kNoEffect ? std::sqrt(pivots[k]) : 0.0;
    jacobian.row(k) *= root;
    residual[k] = root > 0 ? explained[k] / root : 0.0;
  }
  residual[count] = std::sqrt(std::max(cost - residual.squaredNorm(), 0.0));
}

namespace {

// Bounds of σ/Tc and Tc/k in units of the data: a straight line, and a branch that is vertical; a
// rigid rig, and one in which the contact is rigid.
const double kLowestLogRate = std::log(1e-4);
const double kHighestLogRate = std::log(1e9);
const double kLowestLogTravel = std::log(1e-9);
const double kHighestLogTravel = std::log(1e3);

/// Returns ln of the largest force of a steady loop about its middle, below which Tc has no loop.
double LeastLogSlipForce(const Problem& problem) {
  constexpr double kShortOfSlip = 1e-9;
  double largest = 0.0;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    if (problem.states[r] != models::InitialState::kSteady) continue;
    const ScaledRecord& record = problem.data->records[r];
    const auto [low, high] = std::ranges::minmax(record.excitation());
    largest = std::max(largest, (high - low) / 2);
  }
  return std::log(largest) + kShortOfSlip;  // −∞ where none is steady
}

/// A column as the problem's functions write it.
std::span<double> Writable(Eigen::VectorXd& column) {
  return {column.data(), static_cast<std::size_t>(column.size())};
}

}  // namespace

void ProjectedResidual::Bind(const Problem& problem, Response& response) {
  problem_ = &problem;
  response_ = &response;
  response.Bind(problem);
  held_.assign(problem.parameters.size(), 0);
  for (const std::size_t p : problem.parameters.with_prior()) held_[p] = 1;  // not eliminated
  theta_.resize(problem.parameters.size());
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    theta_[p] = problem.parameters[p].theta;
  }
  response_values_.resize(static_cast<Eigen::Index>(problem.size()));
  ChooseSearched();
  FactoriseColumns();
}

bool ProjectedResidual::MovesColumns(std::size_t parameter) const {
  return ShapesColumns(*problem_, parameter) || problem_->parameters[parameter].term->is_linear;
}

void ProjectedResidual::ChooseSearched() {
  const Parameters& parameters = problem_->parameters;
  const Parameter& stiffness = parameters[kStiffness];
  const Parameter& slip_force = parameters[kSlipForce];
  const Parameter& rig = parameters[kRig];
  const auto is_tied = [](const Parameter& parameter) {
    return parameter.fixed || parameter.bounded_by_user || parameter.has_prior();
  };
  scale_is_linear_ = is_forced()
                         ? !is_tied(stiffness)
                         : !slip_force.fixed && !slip_force.has_prior() && !is_tied(stiffness) &&
                               !(parameters.has_rig() && is_tied(rig));
  searched_.clear();
  dependences_.clear();
  const auto search = [&](std::size_t p, double lower, double upper) {
    searched_.push_back({.parameter = p, .lower = lower, .upper = upper});
    Dependence on = DependenceOn(*problem_, p);
    // Summands proportional to t move the scale, where that is eliminated.
    if (scale_is_linear_) {
      std::erase_if(on.summands, [](const Sensitivity& summand) { return !summand.column; });
    }
    dependences_.push_back(std::move(on));
  };
  const auto eliminate = [&](std::size_t p, double lower, double upper, double LawPoint::*point) {
    searched_.push_back({.parameter = p, .lower = lower, .upper = upper, .eliminated = point});
    dependences_.push_back({p, {{.column = parameters[p].term->id}}});
  };
  if (scale_is_linear_ && !is_forced()) {
    eliminate(kStiffness, kLowestLogRate, kHighestLogRate, &LawPoint::log_rate);
    if (parameters.has_rig()) {
      eliminate(kRig, kLowestLogTravel, kHighestLogTravel, &LawPoint::log_travel);
    }
  }
  for (const std::size_t p : {kStiffness, kSlipForce, kRig}) {
    const bool is_eliminated = is_forced() ? scale_is_linear_ && p == kStiffness : scale_is_linear_;
    if (is_eliminated || parameters[p].fixed) continue;
    const bool has_least = is_forced() && p == kSlipForce;
    search(
        p,
        has_least ? std::max(slip_force.lower, LeastLogSlipForce(*problem_)) : parameters[p].lower,
        parameters[p].upper);
  }
  for (const std::size_t p : parameters.free()) {
    const bool is_searched = p == kShape || p >= kLoadExponent;
    if (!is_searched || (parameters[p].term->is_linear && !parameters[p].has_prior())) continue;
    search(p, parameters[p].lower, parameters[p].upper);
  }
}

void ProjectedResidual::FactoriseColumns() {
  const auto size = static_cast<Eigen::Index>(problem_->size());
  weight_.resize(size);
  measured_.resize(size);
  std::size_t row = 0;
  for (std::size_t r = 0; r < problem_->data->records.size(); ++r) {
    const ScaledRecord& record = problem_->data->records[r];
    std::ranges::copy(record.root_weight, weight_.data() + row);
    std::ranges::copy(record.response(), measured_.data() + row);
    const std::span<double> rows = Writable(measured_).subspan(row, record.size());
    for (std::size_t p = 0; p < theta_.size(); ++p) {
      const Parameter& parameter = problem_->parameters[p];
      if (!parameter.term->is_linear || theta_[p] == 0 || (!parameter.fixed && held_[p] == 0))
        continue;
      AddColumn(*problem_, p, r, theta_, -theta_[p], rows);
    }
    row += record.size();
  }
  measured_.array() *= weight_.array();
  columns_.Factorise(*problem_, held_, theta_, weight_);
  measured_products_ = columns_.ProjectOut(measured_);
  response_products_.setZero(measured_products_.size());
}

void ProjectedResidual::ReleaseLinear() {
  bool any = false;
  for (std::size_t p = 0; p < held_.size(); ++p) {
    const unsigned char held = problem_->parameters[p].has_prior() ? 1 : 0;
    any = any || held_[p] != held;
    held_[p] = held;
  }
  if (any) FactoriseColumns();
}

bool ProjectedResidual::HoldPassed(std::span<double> theta) {
  for (const std::size_t p : columns_.parameters()) {
    const Parameter& parameter = problem_->parameters[p];
    if (theta[p] >= parameter.lower && theta[p] <= parameter.upper) continue;
    theta[p] = std::clamp(theta[p], parameter.lower, parameter.upper);
    held_[p] = 1;
    theta_[p] = theta[p];
    FactoriseColumns();
    return true;
  }
  return false;
}

LawPoint ProjectedResidual::PointOf(std::span<const double> u) {
  bool columns_move = false;
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const std::size_t p = searched_[j].parameter;
    if (searched_[j].eliminated != nullptr) continue;
    columns_move = columns_move || (theta_[p] != u[j] && MovesColumns(p));
    theta_[p] = u[j];
  }
  if (columns_move) FactoriseColumns();
  LawPoint point = PointAt(*problem_, theta_);
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    if (searched_[j].eliminated != nullptr) point.*searched_[j].eliminated = u[j];
  }
  return point;
}

void ProjectedResidual::Load(std::span<const double> theta, std::span<double> u) const {
  const LawPoint point = PointAt(*problem_, theta);
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const SearchedParameter& s = searched_[j];
    const double value = s.eliminated != nullptr ? point.*s.eliminated : theta[s.parameter];
    u[j] = std::clamp(value, s.lower, s.upper);
  }
}

void ProjectedResidual::Store(std::span<const double> u, std::span<double> theta) const {
  for (const std::size_t p : {kStiffness, kSlipForce, kRig}) {
    if (problem_->parameters[p].fixed) theta[p] = theta_[p];
  }
  const double log_scale = std::log(scale_);
  if (!is_forced() && !problem_->parameters[kSlipForce].fixed) theta[kSlipForce] = log_scale;
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const SearchedParameter& s = searched_[j];
    theta[s.parameter] = s.eliminated == &LawPoint::log_rate     ? u[j] + log_scale
                         : s.eliminated == &LawPoint::log_travel ? log_scale - u[j]
                                                                 : u[j];
  }
  if (is_forced() && scale_is_linear_) theta[kStiffness] = theta[kSlipForce] - log_scale;
  columns_.Solve(LinearProducts(), theta);
}

/// Returns the bounds of the factor of t, from those of Tc, or of σ for a displacement.
std::pair<double, double> ProjectedResidual::BoundsOfScale(double log_rate) const {
  if (is_forced()) {
    const Parameter& stiffness = problem_->parameters[kStiffness];
    return {std::exp(-log_rate - stiffness.upper), std::exp(-log_rate - stiffness.lower)};
  }
  const Parameter& slip_force = problem_->parameters[kSlipForce];
  return {std::exp(slip_force.lower), std::exp(slip_force.upper)};
}

/// Computes, from t, which is there without weights: projections, its factor and the residual.
/// @returns the sum of squares; infinity where t is that of no displacement
double ProjectedResidual::Regress(double log_rate, bool is_free, double held_scale) {
  response_values_.array() *= weight_.array();
  response_products_ = columns_.ProjectOut(response_values_);
  scale_ = held_scale;
  scale_is_free_ = false;
  if (is_free) {
    const auto [lower, upper] = BoundsOfScale(log_rate);
    const double square = response_values_.squaredNorm();
    const double best = square > 0 ? response_values_.dot(measured_) / square : 0.0;
    scale_ = std::clamp(best, lower, upper);
    scale_is_free_ = scale_ == best;
    if (!(best > 0)) scale_ = lower;
  }
  residual_ = scale_ * response_values_ - measured_;
  const double cost = residual_.squaredNorm() + problem_->parameters.PriorCost(theta_);
  return std::isnan(cost) ? std::numeric_limits<double>::infinity() : cost;
}

double ProjectedResidual::Evaluate(std::span<const double> u) {
  const LawPoint point = PointOf(u);
  response_->Evaluate(point, Writable(response_values_));
  return Regress(point.log_rate, scale_is_linear_, std::exp(LogScaleAt(*problem_, theta_)));
}

double ProjectedResidual::EvaluateFreely(const LawPoint& at, std::span<double> theta) {
  response_->Evaluate(at, Writable(response_values_));
  const std::size_t of_scale = is_forced() ? kStiffness : kSlipForce;
  const bool fixed = problem_->parameters[of_scale].fixed;
  const double held = is_forced() ? -at.log_rate - theta_[kStiffness] : theta_[kSlipForce];
  const double cost = Regress(at.log_rate, !fixed, std::exp(held));
  if (!fixed && !(response_values_.dot(measured_) > 0)) {
    return std::numeric_limits<double>::infinity();
  }
  if (is_forced()) theta[kSlipForce] = -at.log_rate;
  theta[of_scale] = is_forced() ? -at.log_rate - std::log(scale_) : std::log(scale_);
  columns_.Solve(LinearProducts(), theta);
  return cost;
}

double ProjectedResidual::Linearise(std::span<const double> u) {
  const LawPoint point = PointOf(u);
  const auto count = static_cast<Eigen::Index>(searched_.size());
  derivatives_.resize(response_values_.size(), count);
  DifferentiateResponse(*problem_, point, *response_, dependences_, Writable(response_values_),
                        {derivatives_.data(), static_cast<std::size_t>(derivatives_.size())});
  const double cost =
      Regress(point.log_rate, scale_is_linear_, std::exp(LogScaleAt(*problem_, theta_)));
  DifferentiateColumns();
  const double square = scale_is_free_ ? response_values_.squaredNorm() : 0.0;
  for (Eigen::Index j = 0; j < count; ++j) {
    auto column = derivatives_.col(j);
    column.array() *= scale_ * weight_.array();
    columns_.ProjectOut(column);
    if (square > 0) column -= response_values_.dot(column) / square * response_values_;
  }
  gradient_ = derivatives_.transpose() * residual_;
  normal_.resize(count, count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index other = 0; other <= j; ++other) {
      normal_(j, other) = normal_(other, j) = derivatives_.col(j).dot(derivatives_.col(other));
    }
    const auto k = static_cast<std::size_t>(j);
    const Parameter& parameter = problem_->parameters[searched_[k].parameter];
    if (!parameter.has_prior()) continue;
    const double weight = parameter.prior_root_weight * parameter.prior_root_weight;
    normal_(j, j) += weight;
    gradient_[j] += weight * (u[k] - parameter.prior_theta);
  }
  return cost;
}

/// Adds the derivatives by linear parameters that are searched and by what shapes linear columns,
/// over the scale and without weights, at the linear parameters that were eliminated.
void ProjectedResidual::DifferentiateColumns() {
  if (std::ranges::none_of(searched_, [this](const SearchedParameter& searched) {
        return MovesColumns(searched.parameter);
      })) {
    return;
  }
  std::vector<double> theta = theta_;
  columns_.Solve(LinearProducts(), theta);
  double* column = derivatives_.data();
  for (const SearchedParameter& searched : searched_) {
    for (std::size_t r = 0; r < problem_->data->records.size(); ++r) {
      const std::size_t size = problem_->data->records[r].size();
      AddDerivativeOfColumns(*problem_, searched.parameter, r, theta, 1 / scale_, {column, size});
      column += size;
    }
  }
}

}  // namespace mindahl::identification
