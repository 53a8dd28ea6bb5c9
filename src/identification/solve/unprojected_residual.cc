#include "identification/solve/unprojected_residual.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// The cost function of some samples.
class SampleCost final : public ceres::CostFunction {
 public:
  SampleCost(std::shared_ptr<UnprojectedResidual> residual, std::size_t first, std::size_t count)
      : residual_(std::move(residual)), first_(first), count_(count) {
    set_num_residuals(static_cast<int>(count));
    mutable_parameter_block_sizes()->assign(residual_->blocks().size(), 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    residual_->MoveTo(parameters, jacobians != nullptr);
    bool is_finite = Copy(residual_->residual(), residuals);
    for (std::size_t b = 0; jacobians != nullptr && b < residual_->blocks().size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      is_finite = Copy(residual_->Derivative(b), jacobians[b]) && is_finite;
    }
    return is_finite;  // Ceres would print what is no number
  }

 private:
  /// @returns whether the values are finite
  bool Copy(std::span<const double> values, double* to) const {
    const std::span<const double> some = values.subspan(first_, count_);
    std::ranges::copy(some, to);
    return std::ranges::all_of(some, [](double value) { return std::isfinite(value); });
  }

  std::shared_ptr<UnprojectedResidual> residual_;
  std::size_t first_;
  std::size_t count_;
};

}  // namespace

UnprojectedResidual::UnprojectedResidual(const Problem& problem, double unit)
    : problem_(problem), unit_(unit), residual_(problem.size()) {
  const Parameters& parameters = problem.parameters;
  for (const Parameter& parameter : parameters) theta_.push_back(parameter.theta);
  for (const std::size_t p : parameters.reported()) {
    const std::size_t record = parameters[p].record;
    const bool is_steady_origin = p == parameters.PositionOfOrigin(record) &&
                                  problem.states[record] == models::InitialState::kSteady;
    if (!is_steady_origin) blocks_.push_back(p);
  }
  response_.Bind(problem);
  jacobian_.resize(samples() * blocks_.size());
}

void UnprojectedResidual::MoveTo(double const* const* theta, bool with_jacobian) {
  bool is_there = at_.size() == blocks_.size();
  for (std::size_t b = 0; b < at_.size(); ++b) is_there = is_there && at_[b] == *theta[b];
  if (is_there && (has_jacobian_ || !with_jacobian)) return;
  at_.resize(blocks_.size());
  for (std::size_t b = 0; b < at_.size(); ++b) theta_[blocks_[b]] = at_[b] = *theta[b];
  const std::span<const std::size_t> columns =
      with_jacobian ? std::span<const std::size_t>(blocks_) : std::span<const std::size_t>();
  try {
    Differentiate(problem_, theta_, response_, columns, residual_, jacobian_);
  } catch (const InvalidArgument&) {  // no law: exp(θ) is 0 or infinite
    std::ranges::fill(residual_, std::numeric_limits<double>::quiet_NaN());
  }
  for (double& value : residual_) value /= unit_;
  has_jacobian_ = with_jacobian;
  if (!with_jacobian) return;
  for (double& value : jacobian_) value /= unit_;
}

std::unique_ptr<ceres::CostFunction> CostOf(std::shared_ptr<UnprojectedResidual> residual) {
  const std::size_t samples = residual->samples();
  return std::make_unique<SampleCost>(std::move(residual), 0, samples);
}

void AddResidual(const std::shared_ptr<UnprojectedResidual>& residual,
                 const std::vector<double*>& blocks, ceres::LossFunction* loss,
                 ceres::Problem& problem) {
  if (loss == nullptr) {
    problem.AddResidualBlock(CostOf(residual).release(), nullptr, blocks);
    return;
  }
  for (std::size_t i = 0; i < residual->samples(); ++i) {
    problem.AddResidualBlock(std::make_unique<SampleCost>(residual, i, 1).release(), loss, blocks);
  }
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
