#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "identification/problem/problem.h"

namespace mindahl::identification {

/// The weighted residuals of a problem, model − measured over a unit, as a function of θ, with the
/// analytic Jacobian. Keeps the last evaluation, so that its samples can be asked for one by one.
class UnprojectedResidual {
 public:
  /// @param problem  must outlive this
  /// @param unit     by which residuals are divided [units of the data]
  UnprojectedResidual(const Problem& problem, double unit);
  UnprojectedResidual(const UnprojectedResidual&) = delete;
  UnprojectedResidual& operator=(const UnprojectedResidual&) = delete;

  /// Positions of the parameter blocks among the problem's parameters, all of size one: those that
  /// the fit reports, but for the reference position of a steady contact, which has no effect.
  [[nodiscard]] std::span<const std::size_t> blocks() const { return blocks_; }
  [[nodiscard]] std::size_t samples() const { return residual_.size(); }

  /// Evaluates at the blocks' θ, unless it has been done there.
  void MoveTo(double const* const* theta, bool with_jacobian);
  [[nodiscard]] std::span<const double> residual() const { return residual_; }
  /// ∂residual/∂θ of a block.
  [[nodiscard]] std::span<const double> Derivative(std::size_t block) const {
    return {jacobian_.data() + block * samples(), samples()};
  }

 private:
  const Problem& problem_;
  double unit_;
  std::vector<std::size_t> blocks_;
  Response response_;
  std::vector<double> theta_;
  std::vector<double> at_;  // of the blocks
  bool has_jacobian_ = false;
  std::vector<double> residual_;
  std::vector<double> jacobian_;
};

/// The cost function of all samples.
std::unique_ptr<ceres::CostFunction> CostOf(std::shared_ptr<UnprojectedResidual> residual);

/// Adds a residual block; with a loss one a sample, which share their evaluations, so that they
/// belong to one thread.
/// @param blocks  θ of the residual's blocks, in order
/// @param loss    may be null; the problem takes it as its options have it
void AddResidual(const std::shared_ptr<UnprojectedResidual>& residual,
                 const std::vector<double*>& blocks, ceres::LossFunction* loss,
                 ceres::Problem& problem);

/// Bounds a parameter block of one θ, or holds it, where the problem has it.
void BoundBlock(double* theta, bool fixed, double lower, double upper, ceres::Problem& problem);

}  // namespace mindahl::identification
