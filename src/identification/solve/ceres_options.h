#pragma once

#include <ceres/solver.h>

#include <limits>

#include "identification/solve/solver.h"

namespace mindahl::identification {

/// Returns what every search by ceres::Solve is asked for. Its gradient has no scale of its own, so
/// that only a gradient of zero ends a search.
inline ceres::Solver::Options CeresOptionsOf(const SolverOptions& options,
                                             ceres::LinearSolverType linear_solver) {
  ceres::Solver::Options search;
  search.linear_solver_type = linear_solver;
  search.max_num_iterations = options.max_iterations;
  search.function_tolerance = options.function_tolerance;
  search.parameter_tolerance = options.parameter_tolerance;
  search.gradient_tolerance = std::numeric_limits<double>::min();
  search.logging_type = ceres::SILENT;
  return search;
}

}  // namespace mindahl::identification
