#include "identification/solve/unprojected_residual.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// Puts the loss of a residual in its place.
/// @returns the derivative by the residual
double ApplyLoss(const ceres::LossFunction& loss, double& residual) {
  std::array<double, 3> rho{};  // and its derivatives by the square
  loss.Evaluate(residual * residual, rho.data());
  const bool is_zero = !(rho[0] > 0);  // or its square is
  const double slope =
      is_zero ? std::sqrt(rho[1]) : rho[1] * std::abs(residual) / std::sqrt(rho[0]);
  residual = std::copysign(std::sqrt(rho[0]), residual);
  return slope;
}

bool AreFinite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

}  // namespace

UnprojectedResidual::UnprojectedResidual(const Problem& problem, double unit,
                                         std::unique_ptr<ceres::LossFunction> loss)
    : problem_(problem),
      unit_(unit),
      loss_(std::move(loss)),
      blocks_(BlocksOf(problem)),
      response_(problem) {
  set_num_residuals(static_cast<int>(problem.size()));
  mutable_parameter_block_sizes()->assign(blocks_.size(), 1);
}

std::vector<std::size_t> UnprojectedResidual::BlocksOf(const Problem& problem) {
  const Parameters& parameters = problem.parameters;
  std::vector<std::size_t> blocks;
  for (const std::size_t p : parameters.reported()) {
    const bool is_origin = p == parameters.PositionOfOrigin(parameters[p].record);
    if (problem.is_virgin() || !is_origin) blocks.push_back(p);
  }
  return blocks;
}

bool UnprojectedResidual::Evaluate(double const* const* parameters, double* residuals,
                                   double** jacobians) const {
  std::vector<double> theta;
  for (const Parameter& parameter : problem_.parameters) theta.push_back(parameter.theta);
  std::vector<std::size_t> wanted;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    theta[blocks_[b]] = *parameters[b];
    if (jacobians != nullptr && jacobians[b] != nullptr) wanted.push_back(blocks_[b]);
  }
  const std::span<double> residual(residuals, problem_.size());
  std::vector<double> jacobian(wanted.size() * residual.size());
  try {
    Differentiate(problem_, theta, response_, wanted, residual, jacobian);
  } catch (const InvalidArgument&) {  // no law: exp(θ) is 0 or infinite
    return false;
  }
  // Ceres would print what is no number.
  if (!AreFinite(residual) || !AreFinite(jacobian)) return false;
  std::vector<double> slope(residual.size(), 1 / unit_);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual[i] /= unit_;
    if (loss_) slope[i] *= ApplyLoss(*loss_, residual[i]);
  }
  auto column = jacobian.begin();
  for (std::size_t b = 0; jacobians != nullptr && b < blocks_.size(); ++b) {
    if (jacobians[b] == nullptr) continue;
    std::ranges::transform(slope, std::span(column, residual.size()), jacobians[b],
                           std::multiplies());
    column += std::ssize(residual);
  }
  return true;
}

void BoundBlock(double* theta, bool fixed, double lower, double upper, ceres::Problem& problem) {
  if (!problem.HasParameterBlock(theta)) return;
  if (fixed) {
    problem.SetParameterBlockConstant(theta);
    return;
  }
  *theta = std::clamp(*theta, lower, upper);
  problem.SetParameterLowerBound(theta, 0, lower);
  problem.SetParameterUpperBound(theta, 0, upper);
}

}  // namespace mindahl::identification
