#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "identification/problem/problem.h"

namespace mindahl::identification {

/// The weighted residuals of a problem, model − measured over a unit, of every sample, as a
/// function of θ with the analytic Jacobian. With a loss each residual r is sgn(r)·√ρ(r²), of which
/// half the square is the loss.
class UnprojectedResidual final : public ceres::CostFunction {
 public:
  /// @param problem  must outlive this
  /// @param unit     by which residuals are divided [units of the data]
  /// @param loss     may be null: least squares
  UnprojectedResidual(const Problem& problem, double unit,
                      std::unique_ptr<ceres::LossFunction> loss);

  /// Returns the positions of the parameter blocks among the problem's parameters, all of size one:
  /// those that the fit reports, but for the reference position of a steady contact, which has no
  /// effect.
  static std::vector<std::size_t> BlocksOf(const Problem& problem);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const Problem& problem_;
  double unit_;
  std::unique_ptr<ceres::LossFunction> loss_;
  std::vector<std::size_t> blocks_;
  mutable Response response_;  // an evaluation reuses the buffers of the last one
};

/// Bounds a parameter block of one θ, or holds it, where the problem has it.
void BoundBlock(double* theta, bool fixed, double lower, double upper, ceres::Problem& problem);

}  // namespace mindahl::identification
