#pragma once

#include <string>
#include <string_view>

namespace mindahl::identification {

/// How the search of a fit ended, as Ceres reports it.
struct SolverReport {
  /// "tiny_solver" (ceres::TinySolver), "solve" (ceres::Solve), or "none" where every parameter
  /// that is not linear is fixed.
  std::string_view solver = "none";
  /// Ceres' termination type: CONVERGENCE, NO_CONVERGENCE, FAILURE; "not run".
  std::string_view termination = "not run";
  std::string message = "not run";  ///< Ceres' reason
  int iterations = 0;               ///< sum over all searches from this start
  double initial_cost = 0.0;        ///< ½ Σ of the squared weighted residuals [N² or m²]
  double final_cost = 0.0;          ///< likewise
};

}  // namespace mindahl::identification
