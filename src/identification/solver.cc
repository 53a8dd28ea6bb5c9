#include "identification/solver.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace mindahl::identification {
namespace {

/// All residuals as one block: the gradient is ours, in closed form.
class ForceCost : public ceres::CostFunction {
 public:
  ForceCost(const ForceResidual& residual, const ParameterLayout& layout, std::vector<double> theta)
      : residual_(residual), layout_(layout), theta_(std::move(theta)) {
    set_num_residuals(static_cast<int>(residual.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(layout.free().size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    std::vector<double> theta = theta_;
    const std::vector<std::size_t>& free = layout_.free();
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (!std::isfinite(parameters[0][i])) return false;
      theta[free[i]] = parameters[0][i];
    }
    const std::span<double> out(residuals, residual_.size());
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      residual_.Evaluate(theta, out);
    } else {
      residual_.Differentiate(theta, free, out, {jacobians[0], residual_.size() * free.size()});
    }
    return true;
  }

 private:
  const ForceResidual& residual_;
  const ParameterLayout& layout_;
  std::vector<double> theta_;  // the fixed ones' values
};

/// Ends a walk along a valley floor: near gross slip the residuals have kinks in α and Tc, and
/// steps may go on for ever without a gain that any data could show.
class NoMoreLikelihood : public ceres::IterationCallback {
 public:
  explicit NoMoreLikelihood(std::size_t samples) : samples_(static_cast<double>(samples)) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    costs_.push_back(summary.cost);
    if (costs_.size() <= kSteps) return ceres::SOLVER_CONTINUE;
    const double before = costs_[costs_.size() - 1 - kSteps];
    const double gain = samples_ * (before - summary.cost) / before;  // of twice the log-likelihood
    return gain < kSmallestGain ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  static constexpr std::size_t kSteps = 20;
  static constexpr double kSmallestGain = 1e-3;
  double samples_;
  std::vector<double> costs_;
};

}  // namespace

Solution Solve(const ForceResidual& residual, const ParameterLayout& layout,
               std::vector<double> start, const FitOptions& options) {
  const std::vector<std::size_t>& free = layout.free();
  std::vector<double> free_theta;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const ScaledParameter& parameter = layout.parameters()[i];
    if (parameter.fixed) start[i] = parameter.theta;
  }
  for (const std::size_t i : free) {
    // Ceres takes a start outside the bounds without a word and then fails.
    const ScaledParameter& parameter = layout.parameters()[i];
    free_theta.push_back(std::clamp(start[i], parameter.lower, parameter.upper));
  }

  Solution solution;
  solution.theta = std::move(start);
  if (free.empty()) {
    solution.sum_of_squares = residual.SumOfSquares(solution.theta);
    solution.converged = true;
    solution.termination = "every parameter is fixed";
    return solution;
  }

  ForceCost cost(residual, layout, solution.theta);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(&cost, nullptr, free_theta.data());
  for (std::size_t i = 0; i < free.size(); ++i) {
    const ScaledParameter& parameter = layout.parameters()[free[i]];
    problem.SetParameterLowerBound(free_theta.data(), static_cast<int>(i), parameter.lower);
    problem.SetParameterUpperBound(free_theta.data(), static_cast<int>(i), parameter.upper);
  }

  ceres::Solver::Options solver_options;
  solver_options.linear_solver_type = ceres::DENSE_QR;
  solver_options.logging_type = ceres::SILENT;
  solver_options.max_num_iterations = options.max_iterations;
  solver_options.function_tolerance = options.function_tolerance;
  solver_options.parameter_tolerance = options.parameter_tolerance;
  // A noise-free record has a gradient of rounding errors only; steps decide.
  solver_options.gradient_tolerance = 1e-16;
  NoMoreLikelihood no_more_likelihood(residual.size());
  solver_options.callbacks.push_back(&no_more_likelihood);
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &problem, &summary);

  for (std::size_t i = 0; i < free.size(); ++i) solution.theta[free[i]] = free_theta[i];
  solution.sum_of_squares = residual.SumOfSquares(solution.theta);
  solution.converged = (summary.termination_type == ceres::CONVERGENCE ||
                        summary.termination_type == ceres::USER_SUCCESS) &&
                       std::isfinite(solution.sum_of_squares);
  solution.iterations = static_cast<int>(summary.iterations.size());
  solution.termination =
      summary.termination_type == ceres::USER_SUCCESS
          ? "Twenty steps together raised twice the log-likelihood by less than 1e-3."
          : summary.message;
  return solution;
}

}  // namespace mindahl::identification
