#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <functional>
#include <memory>

#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Adds the weighted residuals of a problem, model − measured over a unit, of every sample, with
/// their analytic Jacobian, as one residual block. Its parameter blocks, each a θ, are those of the
/// parameters that the fit reports, but for the reference position of a steady contact, which has
/// no effect. With a loss, which may be null, each residual r is replaced by sgn(r)·√ρ(r²), of
/// which half the square is the loss.
/// @param problem   must outlive `to`
/// @param unit      by which residuals are divided [units of the data]
/// @param block_of  returns the block of the parameter at a position
void AddResidualBlock(const Problem& problem, double unit,
                      std::unique_ptr<ceres::LossFunction> loss,
                      const std::function<double*(std::size_t)>& block_of, ceres::Problem& to);

/// Bounds a parameter block of one θ, or holds it, where the problem has it.
void BoundBlock(double* theta, bool fixed, double lower, double upper, ceres::Problem& problem);

}  // namespace mindahl::identification
