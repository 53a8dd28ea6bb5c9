#pragma once

#include <Eigen/Sparse>
#include <memory>
#include <memory_resource>
#include <span>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/solver.h"

namespace mindahl::identification {

/// Records whose turning points lie beyond their outermost samples, by an overshoot each.
///
/// A record that is sampled coarsely misses the extremes of its motion; the branches that follow
/// then start in the wrong place, and no other parameter can correct that without a bias.
struct TurnedRecords {
  ScaledRecords data;  // with the turning points inserted next to the outermost samples
  std::pmr::vector<std::pmr::vector<std::size_t>> reversals;  // of `data`, which refers to them
  std::vector<double> overshoot;  // of all records' reversals, in units of the data
};

/// @param overshoot  >= 0, one a reversal of all records
std::unique_ptr<TurnedRecords> PutInTurningPoints(const ScaledRecords& data,
                                                  std::span<const double> overshoot);

/// Returns how far the motion turns beyond a reversal's sample, by the samples about it alone: >=
/// 0, at most the longer of the adjacent steps. It turns where the lines through the two samples
/// before and the two after meet if its velocity changes there and hardly next to it, as that of a
/// triangle does; else at the extremum of the polynomial through the outermost sample and two on
/// each side (one, where the strokes are short). Of a sine of n samples a cycle that is off by at
/// most (2π/n)⁶/200 of the amplitude.
double OvershootOfMotion(const ScaledRecord& record, std::size_t reversal);

/// Returns how far a turning point may lie beyond its sample: the longer of the adjacent steps.
double LongestOvershoot(const ScaledRecord& record, std::size_t reversal);

/// Returns LongestOvershoot() of every reversal of all records.
std::vector<double> LongestOvershoots(const ScaledRecords& data);

/// ∂(weighted force)/∂overshoot, a sparse column a reversal: an overshoot moves the branch that
/// starts there, and those that start on it.
class TurningPointColumns {
 public:
  /// @param problem  of turned records; θ as of the problem
  TurningPointColumns(const Problem& problem, std::span<const double> theta, Response& response);
  explicit TurningPointColumns(const Eigen::SparseMatrix<double>& columns);

  [[nodiscard]] const Eigen::SparseMatrix<double>& columns() const { return columns_; }

  /// Returns the factors of the columns that explain most of another.
  [[nodiscard]] Eigen::VectorXd Fit(const Eigen::VectorXd& column) const;
  /// Takes off a column what those of the turning points explain of it.
  void ProjectOut(Eigen::Ref<Eigen::VectorXd> column) const;

 private:
  Eigen::SparseMatrix<double> columns_;  // samples × reversals
  mutable Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> normal_;
};

/// Holds the residuals that one linear step in all parameters and overshoots leaves, from the
/// solution with some overshoots, and the overshoots after that step.
struct TurningPointStep {
  Eigen::VectorXd left;
  std::vector<double> overshoot;
};
/// @param problem    of the samples alone
/// @param overshoot  to start from
TurningPointStep StepTurningPoints(const Problem& problem, const Solution& solution,
                                   std::span<const double> overshoot, Response& response);

struct TurningPointFit {
  std::unique_ptr<TurnedRecords> records;
  Solution solution;
};

/// Least squares in all free parameters and the overshoots within their bounds, by ceres::Solve
/// with one residual block a stroke: a stroke depends on the few turning points that its branches
/// start from, so that the normal equations are as sparse as the history is shallow.
/// @param overshoot  to start from
TurningPointFit FitTurningPoints(const Problem& problem, const Solution& start,
                                 std::vector<double> overshoot, const SolverOptions& options,
                                 Response& response);

}  // namespace mindahl::identification
