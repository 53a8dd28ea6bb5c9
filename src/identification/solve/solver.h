#pragma once

#include <ceres/solver.h>

#include <span>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/projected_residual.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

struct SolverOptions {
  /// The search stops when a step can lower the cost by function_tolerance · cost at the most, …
  double function_tolerance = 1e-10;
  /// … or |Δu| < parameter_tolerance · (|u| + parameter_tolerance), …
  double parameter_tolerance = 1e-13;
  int max_iterations = 500;
  /// Accepts a full step as the last one if it can lower the cost by at most this fraction.
  double last_step = 1e-8;
  /// Accepts the last step without evaluating the cost there.
  bool predicts_last = false;
  /// Leaves out the second opinion of ceres::Solve: the result is only a start.
  bool is_rough = false;
};

/// Returns what every search by ceres::Solve is asked for. Its gradient has no scale of its own, so
/// that only a gradient of zero ends a search.
ceres::Solver::Options CeresOptionsOf(const SolverOptions& options,
                                      ceres::LinearSolverType linear_solver);

struct Solution {
  std::vector<double> theta = {};    // of all parameters
  std::vector<BoundSide> side = {};  // of all parameters
  double sum_of_squares = 0.0;       // weighted
  bool converged = false;
  SolverReport report = {};  // costs in units of the data
};

/// Least squares by variable projection (projected_residual.h), searched by Ceres:
/// - ceres::TinySolver where the solution lies inside the bounds;
/// - ceres::Solve with the bounds, from there on, where a coordinate ends at one, and wherever
///   TinySolver does not converge. The lower of the two costs is kept.
///
/// Keeps its buffers.
class Solver {
 public:
  /// @param problem  must outlive the solves; its weights may change between them
  void Bind(const Problem& problem) { residual_.Bind(problem, response); }

  /// Moves a parameter that the problem holds, of those without a column of their own.
  void HoldAt(std::size_t parameter, double theta) { residual_.HoldAt(parameter, theta); }

  /// Least cost at a point of the law, with the factor of t eliminated whatever is held, for looks
  /// at the plane of σ/Tc, or of a displacement of Tc, and α.
  /// @returns Σ of the squared weighted residuals; infinity where the regression has the wrong
  /// sign,
  ///   else writes what is eliminated into θ
  double CostAt(const LawPoint& at, std::span<double> theta) {
    return residual_.EvaluateFreely(at, theta);
  }

  /// @param start  θ, moved into the bounds
  void Solve(std::span<const double> start, const SolverOptions& options, Solution& solution);

  Response response;  ///< may be bound to another problem between the solves

 private:
  void SearchFrom(std::span<double> u, const SolverOptions& options, Solution& solution);
  void MarkSides(std::span<const double> u, Solution& solution) const;

  ProjectedResidual residual_;
  std::vector<double> u_;
};

}  // namespace mindahl::identification
