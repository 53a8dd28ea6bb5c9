#include "identification/solve/projected_residual.h"

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <utility>

namespace mindahl::identification {

ProjectedResidual::ProjectedResidual(const Problem& problem)
    : problem_(problem),
      response_(problem),
      theta_(problem.parameters.Theta()),
      weight_(problem.data->All(&ScaledRecord::root_weight)),
      response_values_(weight_.size()) {
  for (const std::size_t p : problem.parameters.free()) {
    const Parameter& parameter = problem.parameters[p];
    const bool is_tied = parameter.has_prior() || parameter.bounded_by_user;
    const bool is_eliminated = parameter.term->is_linear && !is_tied;
    theta_[p] = is_eliminated ? 0.0 : parameter.Clamp(theta_[p]);
    (is_eliminated ? eliminated_ : searched_).push_back(p);
  }
  FactoriseColumns();
}

Eigen::VectorXd ProjectedResidual::SearchedOf(std::span<const double> theta) const {
  Eigen::VectorXd u(std::ssize(searched_));
  for (Eigen::Index j = 0; const std::size_t p : searched_) {
    u[j++] = problem_.parameters[p].Clamp(theta[p]);
  }
  return u;
}

void ProjectedResidual::FactoriseColumns() {
  const Eigen::Index size = weight_.size();
  measured_ = problem_.data->All(&ScaledRecord::response);
  AddLinearTerms(problem_, theta_, -1.0, measured_);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, std::ssize(eliminated_));
  AddDerivativesOfColumns(problem_, eliminated_, theta_, columns);
  measured_.array() *= weight_.array();
  columns.array().colwise() *= weight_.array();
  // A column whose part orthogonal to the others is below this fraction of it depends on them.
  constexpr double kDependent = 1e-12;
  linear_.clear();
  basis_.resize(size, 0);
  triangle_.resize(0, 0);
  if (!eliminated_.empty()) {
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
      linear_.push_back(eliminated_[static_cast<std::size_t>(column)]);
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
  for (Eigen::Index k = 0; const std::size_t p : linear_) theta[p] = values[k++];
}

std::vector<double> ProjectedResidual::Theta() const {
  std::vector<double> theta = theta_;
  SolveLinear(theta);
  return theta;
}

void ProjectedResidual::MoveTo(const Eigen::VectorXd& u) {
  bool columns_move = false;
  for (Eigen::Index j = 0; const std::size_t p : searched_) {
    const Term& term = *problem_.parameters[p].term;
    const double before = std::exchange(theta_[p], u[j++]);
    columns_move |= before != theta_[p] && (term.is_linear || !term.shapes.empty());
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

double ProjectedResidual::Evaluate(const Eigen::VectorXd& u) {
  MoveTo(u);
  response_.Evaluate(theta_, SpanOf(response_values_));
  return Regress(theta_);
}

double ProjectedResidual::EvaluateFreely(std::span<double> theta) {
  response_.Evaluate(theta, SpanOf(response_values_));
  double cost = Regress(theta);
  const bool is_forced = problem_.data->is_forced();
  const std::size_t of_scale = is_forced ? kStiffness : kSlipForce;
  const Parameter& parameter = problem_.parameters[of_scale];
  if (!parameter.fixed) {
    const double best = response_values_.dot(measured_) / response_values_.squaredNorm();
    if (!(best > 0)) return std::numeric_limits<double>::infinity();
    const double log_scale = is_forced ? theta[kSlipForce] - std::log(best) : std::log(best);
    theta[of_scale] = parameter.Clamp(log_scale);
    cost = ScaleTo(theta);
  }
  SolveLinear(theta);
  return cost;
}

double ProjectedResidual::Linearise(const Eigen::VectorXd& u) {
  MoveTo(u);
  response_.Differentiate(theta_, searched_, response_values_, derivatives_);
  const double cost = Regress(theta_);
  AddDerivativesOfColumns(problem_, searched_, Theta(), derivatives_);
  derivatives_.array().colwise() *= weight_.array();
  derivatives_ -= basis_ * (basis_.transpose() * derivatives_);
  gradient_ = derivatives_.transpose() * residual_;
  normal_ = derivatives_.transpose() * derivatives_;
  for (Eigen::Index j = 0; j < derivatives_.cols(); ++j) {
    const Parameter& parameter = Searched(j);
    const double weight = parameter.prior_root_weight * parameter.prior_root_weight;
    normal_(j, j) += weight;
    gradient_[j] += weight * (u[j] - parameter.prior_theta);
  }
  return cost;
}

}  // namespace mindahl::identification
