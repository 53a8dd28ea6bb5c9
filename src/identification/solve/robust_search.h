#pragma once

#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"

namespace mindahl::identification {

/// Constants of the losses, each 95 % efficient for normal noise (Huber 1981; Holland & Welsch
/// 1977).
inline constexpr double kHuberConstant = 1.345;
inline constexpr double kCauchyConstant = 2.385;
inline constexpr double kTukeyConstant = 4.685;

/// Minimises ½ Σ ρ((w·r/scale)²) of the samples by ceres::Solve, one residual block with a
/// ceres::LossFunction a sample and one without a loss a prior, over all free parameters within
/// their bounds.
/// @param loss      not Loss::kNone
/// @param scale     of the weighted residuals [units of the data], > 0
/// @param solution  θ is where the search starts; written but for sum of squares and residual
void SolveRobustly(const Problem& problem, Loss loss, double scale, const SolverOptions& options,
                   Solution& solution);

}  // namespace mindahl::identification
