#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/projected_residual.h"
#include "identification/solve/tiny_search.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

struct Solution {
  std::vector<double> theta;     // of all parameters
  std::vector<BoundSide> side;   // of all parameters
  double sum_of_squares = 0.0;   // weighted
  std::vector<double> residual;  // weighted, model − measured; none where the end was predicted
  bool converged = false;
  SolverReport report;  // costs in units of the data
};

/// Least squares by variable projection (projected_residual.h), searched by Ceres:
/// - ceres::TinySolver where the solution lies inside the bounds;
/// - ceres::Solve with the bounds, from there on, where a coordinate ends at one, and wherever
///   TinySolver does not converge. The lower of the two costs is kept.
///
/// Keeps its buffers.
class Solver {
 public:
  /// @param problem   must outlive the solves; its weights may change between them
  /// @param response  bound to the problem here
  void Bind(const Problem& problem, Response& response) { residual_.Bind(problem, response); }

  /// Moves a parameter that the problem holds, of those without a column of their own.
  void HoldAt(std::size_t parameter, double theta) { residual_.HoldAt(parameter, theta); }

  /// Least cost at the searched parameters of θ: writes the eliminated ones into θ.
  /// @returns Σ of the squared weighted residuals
  double CostAt(std::span<double> theta);

  /// The same with the factor of t eliminated whatever is held, for looks at the plane of σ/Tc, or
  /// of a displacement of Tc, and α.
  /// @returns infinity where the regression has the wrong sign; else σ or Tc in θ
  double CostAt(const LawPoint& at, std::span<double> theta) {
    return residual_.EvaluateFreely(at, theta);
  }

  /// @param start  θ, moved into the bounds
  void Solve(std::span<const double> start, const SolverOptions& options, Solution& solution);

 private:
  void SearchFrom(std::span<double> u, const SolverOptions& options, Solution& solution);
  void MarkSides(std::span<const double> u, Solution& solution) const;

  ProjectedResidual residual_;
  // In 1, 2, 3 and more coordinates, as they are needed.
  std::array<std::unique_ptr<TinySearch>, 4> searches_;
  std::vector<double> u_;
};

}  // namespace mindahl::identification
