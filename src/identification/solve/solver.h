#pragma once

#include <ceres/loss_function.h>

#include <memory>
#include <span>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/projected_residual.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

struct SolverOptions {
  /// The search stops when a step can lower the cost by function_tolerance · cost at the most, …
  double function_tolerance = 1e-10;
  /// … or |Δu| < parameter_tolerance · (|u| + parameter_tolerance), …
  double parameter_tolerance = 2e-14;
  int max_iterations = 500;
  /// Leaves out the second opinion of ceres::Solve: the result is only a start.
  bool is_rough = false;
};

struct Solution {
  std::vector<double> theta = {};  // of all parameters
  double sum_of_squares = 0.0;     // weighted
  bool converged = false;
  SolverReport report = {};  // without its cost
};

/// Returns the loss ρ(z²) of a standardised residual z, which is 95 % efficient for normal noise
/// (Huber 1981; Holland & Welsch 1977): null for none.
std::unique_ptr<ceres::LossFunction> LossOf(Loss loss);

/// Minimises ½ Σ ρ((w·r/scale)²) of the samples, and of the priors without a loss, by ceres::Solve
/// over all free parameters within their bounds.
/// @param scale     of the weighted residuals [units of the data], > 0
/// @param solution  θ is where the search starts; written but for sum of squares and residual
void SolveByCeres(const Problem& problem, Loss loss, double scale, const SolverOptions& options,
                  Solution& solution);

/// Least squares by variable projection (projected_residual.h), searched by Ceres:
/// - ceres::TinySolver where the solution lies inside the bounds;
/// - ceres::Solve with the bounds, from there on, where a coordinate ends at one, and wherever
///   TinySolver does not converge. The lower of the two costs is kept.
/// @param residual  searches of one share the basis of the eliminated columns and the buffers
/// @param start     θ, moved into the bounds
Solution Solve(ProjectedResidual& residual, std::span<const double> start,
               const SolverOptions& options);

}  // namespace mindahl::identification
