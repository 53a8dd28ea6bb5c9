#pragma once

#include <Eigen/Core>
#include <span>

#include "identification/inference/noise.h"
#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {

/// Simulates the effect of errors of the displacement on a model's force, by readings that were
/// drawn again: T(drawn) − T(as smoothed) of the problem's model at θ, in units of the data, one
/// row a sample, one column a drawn set of its records. Their mean is not taken off: the outermost
/// of several noisy samples lies a little too far out, and that too is an error.
Eigen::MatrixXd ForceErrors(const loop::DrawnReadings& drawn, const Problem& problem,
                            std::span<const double> theta);

/// Finds the noise of a fit: known, or of its residuals. Where these have weights it fits again and
/// again under those that the last fit implies, until they settle:
/// - errors of the displacement act as force noise of the variance σ_T² that their draws have at a
///   sample (effective variance, Orear 1982): w = σ_F²/(σ_F² + σ_T²), so that steep branches do not
///   dominate; σ_F² where it is not known is what the residuals leave for it
/// - a robust loss of the standardised residual, whose scale is the median absolute deviation:
///   ceres::Solve minimises it, and the weights ψ(z)/z at the minimum are those of the errors
/// @param data      of the problem: its weights are written
/// @param options   with drawn readings of the records where their displacements are inexact
/// @param solution  refitted from where it is
/// @param noise     what the weights stand for
/// @returns whether they settled
bool FitWithWeights(const Problem& problem, ScaledRecords& data, const FitOptions& options,
                    Solution& solution, Noise& noise);

}  // namespace mindahl::identification
