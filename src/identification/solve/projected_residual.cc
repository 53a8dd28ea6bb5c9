#include "identification/solve/projected_residual.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace mindahl::identification {
namespace {

/// A column as the problem's functions write it.
std::span<double> Writable(Eigen::VectorXd& column) {
  return {column.data(), static_cast<std::size_t>(column.size())};
}

}  // namespace

ProjectedResidual::ProjectedResidual(const Problem& problem)
    : problem_(problem), response_(problem) {
  for (const Parameter& parameter : problem.parameters) theta_.push_back(parameter.theta);
  for (const std::size_t p : problem.parameters.free()) {
    const Parameter& parameter = problem.parameters[p];
    const bool is_tied = parameter.has_prior() || parameter.bounded_by_user;
    if (parameter.term->is_linear && !is_tied) {
      theta_[p] = 0.0;
      continue;
    }
    theta_[p] = std::clamp(theta_[p], parameter.lower, parameter.upper);
    searched_.push_back(p);
  }
  response_values_.resize(static_cast<Eigen::Index>(problem.size()));
  FactoriseColumns();
}

void ProjectedResidual::FactoriseColumns() {
  const ScaledRecords& data = *problem_.data;
  const auto size = static_cast<Eigen::Index>(problem_.size());
  std::vector<std::size_t> eliminated;
  for (std::size_t p = 0; p < theta_.size(); ++p) {
    const Parameter& parameter = problem_.parameters[p];
    const bool is_searched = std::ranges::find(searched_, p) != searched_.end();
    if (parameter.term->is_linear && !parameter.fixed && !is_searched) eliminated.push_back(p);
  }
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, std::ssize(eliminated));
  weight_.resize(size);
  measured_.resize(size);
  for (const ScaledRecord& record : data.records) {
    std::ranges::copy(record.root_weight, record.Of(Writable(weight_)).begin());
    std::ranges::copy(record.response(), record.Of(Writable(measured_)).begin());
  }
  for (std::size_t p = 0; p < theta_.size(); ++p) {
    if (!problem_.parameters[p].term->is_linear || theta_[p] == 0) continue;
    AddColumn(problem_, p, theta_, -theta_[p], Writable(measured_));
  }
  for (std::size_t k = 0; k < eliminated.size(); ++k) {
    double* const column = columns.col(static_cast<Eigen::Index>(k)).data();
    AddColumn(problem_, eliminated[k], theta_, 1.0, {column, problem_.size()});
  }
  measured_.array() *= weight_.array();
  columns.array().colwise() *= weight_.array();
  // A column whose part orthogonal to the others is below this fraction of it depends on them.
  constexpr double kDependent = 1e-12;
  linear_.clear();
  basis_.resize(size, 0);
  triangle_.resize(0, 0);
  if (!eliminated.empty()) {
    const Eigen::VectorXd norms = columns.colwise().norm();
    columns.array().rowwise() /= norms.transpose().array().max(std::numeric_limits<double>::min());
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(columns);
    factors.setThreshold(kDependent);
    const Eigen::Index rank = factors.rank();
    basis_ = factors.householderQ() * Eigen::MatrixXd::Identity(size, rank);
    triangle_ = factors.matrixR().topLeftCorner(rank, rank);
    for (Eigen::Index k = 0; k < rank; ++k) {
      const Eigen::Index column = factors.colsPermutation().indices()[k];
      triangle_.col(k) *= norms[column];
      linear_.push_back(eliminated[static_cast<std::size_t>(column)]);
    }
  }
  measured_products_ = ProjectOut(measured_);
}

/// Makes a column orthogonal to the basis.
/// @returns its products with the basis
Eigen::VectorXd ProjectedResidual::ProjectOut(Eigen::Ref<Eigen::VectorXd> column) const {
  Eigen::VectorXd products = basis_.transpose() * column;
  column -= basis_ * products;
  return products;
}

/// Writes the linear parameters at the last evaluation; those that depend on others are as held.
void ProjectedResidual::SolveLinear(std::span<double> theta) const {
  const Eigen::VectorXd values = triangle_.triangularView<Eigen::Upper>().solve(
      measured_products_ - scale_ * response_products_);
  for (std::size_t k = 0; k < linear_.size(); ++k) {
    theta[linear_[k]] = values[static_cast<Eigen::Index>(k)];
  }
}

std::vector<double> ProjectedResidual::Theta() const {
  std::vector<double> theta = theta_;
  SolveLinear(theta);
  return theta;
}

void ProjectedResidual::MoveTo(std::span<const double> u) {
  bool columns_move = false;
  for (std::size_t j = 0; j < u.size(); ++j) {
    const std::size_t p = searched_[j];
    const Term& term = *problem_.parameters[p].term;
    const bool has_column = term.is_linear || !term.shapes.empty();
    columns_move = columns_move || (has_column && theta_[p] != u[j]);
    theta_[p] = u[j];
  }
  if (columns_move) FactoriseColumns();
}

/// Computes the residual from t, which is there without weights.
/// @returns the sum of squares; infinity where t is that of no displacement
double ProjectedResidual::Regress(std::span<const double> theta) {
  response_values_.array() *= weight_.array();
  response_products_ = ProjectOut(response_values_);
  return ScaleTo(theta);
}

/// Computes the residual from t, which is weighted and projected.
/// @returns likewise
double ProjectedResidual::ScaleTo(std::span<const double> theta) {
  scale_ = std::exp(LogScaleAt(problem_, theta));
  residual_ = scale_ * response_values_ - measured_;
  const double cost = residual_.squaredNorm() + problem_.parameters.PriorCost(theta);
  return std::isnan(cost) ? std::numeric_limits<double>::infinity() : cost;
}

double ProjectedResidual::Evaluate(std::span<const double> u) {
  MoveTo(u);
  response_.Evaluate(theta_, Writable(response_values_));
  return Regress(theta_);
}

double ProjectedResidual::EvaluateFreely(std::span<double> theta) {
  response_.Evaluate(theta, Writable(response_values_));
  double cost = Regress(theta);
  const std::size_t of_scale = is_forced() ? kStiffness : kSlipForce;
  const Parameter& parameter = problem_.parameters[of_scale];
  if (!parameter.fixed) {
    const double best = response_values_.dot(measured_) / response_values_.squaredNorm();
    if (!(best > 0)) return std::numeric_limits<double>::infinity();
    const double log_scale = is_forced() ? theta[kSlipForce] - std::log(best) : std::log(best);
    theta[of_scale] = std::clamp(log_scale, parameter.lower, parameter.upper);
    cost = ScaleTo(theta);
  }
  SolveLinear(theta);
  return cost;
}

double ProjectedResidual::Linearise(std::span<const double> u) {
  MoveTo(u);
  const auto count = static_cast<Eigen::Index>(u.size());
  derivatives_.resize(response_values_.size(), count);
  DifferentiateResponse(problem_, theta_, response_, searched_, Writable(response_values_),
                        {derivatives_.data(), static_cast<std::size_t>(derivatives_.size())});
  const double cost = Regress(theta_);
  derivatives_ *= scale_;
  const std::vector<double> theta = Theta();
  double* column = derivatives_.data();
  for (const std::size_t p : searched_) {
    AddDerivativeOfColumns(problem_, p, theta, {column, problem_.size()});
    column += problem_.size();
  }
  derivatives_.array().colwise() *= weight_.array();
  derivatives_ -= basis_ * (basis_.transpose() * derivatives_);
  gradient_ = derivatives_.transpose() * residual_;
  normal_ = derivatives_.transpose() * derivatives_;
  for (Eigen::Index j = 0; j < count; ++j) {
    const Parameter& parameter = Searched(static_cast<std::size_t>(j));
    const double weight = parameter.prior_root_weight * parameter.prior_root_weight;
    normal_(j, j) += weight;
    gradient_[j] += weight * (u[static_cast<std::size_t>(j)] - parameter.prior_theta);
  }
  return cost;
}

}  // namespace mindahl::identification
