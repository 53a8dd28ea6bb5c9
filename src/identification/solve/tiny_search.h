#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "identification/solve/projected_residual.h"

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

/// ceres::TinySolver with what the searches of one start share.
///
/// TinySolver has neither bounds nor limits of a step, evaluates a trial without its Jacobian, and
/// stops by the absolute change of the cost. Its cost functor therefore
/// - evaluates a coordinate beyond its bound at the bound, where its derivative is 0;
/// - ends the search where a trial moves a coordinate further than one step may, and goes on with
///   a trust region in which it does not;
/// - linearises a trial at once, as an accepted one is linearised next;
/// - reports a zero gradient, which ends the search, where no step can lower the cost by more than
///   the function tolerance.
class TinySearch {
 public:
  /// Makes a search in `count` coordinates, in matrices of that size where they are few.
  static std::unique_ptr<TinySearch> Make(std::size_t count);

  virtual ~TinySearch() = default;

  /// @param of        must outlive the runs
  /// @param rounding  the cost below which residuals are rounding errors
  void Start(ProjectedResidual& of, const SolverOptions& with, double rounding);

  /// Searches from u, which it moves.
  virtual void Run(std::span<double> u) = 0;

  /// Passes the residual at u to a run that begins there: it was linearised last.
  void KnowsLinearised(std::span<const double> u, double cost);

  // Results of the last run.
  [[nodiscard]] double cost() const { return cost_; }
  [[nodiscard]] double initial_cost() const { return initial_cost_; }  // half of it, as Ceres'
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] virtual bool hit_maximum() const = 0;
  /// True if twenty steps together gained next to nothing, and it was left at that.
  [[nodiscard]] bool is_slow() const { return is_slow_; }
  [[nodiscard]] virtual const char* Message() const = 0;
  /// True if the residual was evaluated, or predicted, at u last.
  [[nodiscard]] bool IsEvaluatedAt(std::span<const double> u) const;
  [[nodiscard]] bool is_predicted() const { return trial_is_predicted_; }

  /// Returns memory for a mark of each coordinate.
  [[nodiscard]] std::vector<unsigned char>& marks() { return clamped_; }

 protected:
  /// A residual that refuses a trial by less than the function tolerance, which ends the search.
  [[nodiscard]] double EndOfSearch() const;
  void Clamp(const double* x, std::vector<double>& to) const;
  [[nodiscard]] bool IsTooLong(std::size_t j, double step) const;
  /// True if the trial can be evaluated; else the first residual says what becomes of the search.
  [[nodiscard]] bool IsAllowed(const double* x, double& residual);
  void FindClamped(const double* x);
  void CountAccepted();

  ProjectedResidual* residual_ = nullptr;
  SolverOptions options_;
  std::size_t count_ = 0;
  double floor_ = 0.0;         // of the cost: below it residuals are rounding errors
  std::vector<double> at_;     // accepted coordinates, within their bounds
  std::vector<double> raw_;    // as TinySolver has them
  std::vector<double> trial_;  // the last evaluated ones
  std::vector<unsigned char> clamped_;
  double cost_ = 0.0;  // there
  double trial_cost_ = 0.0;
  bool trial_is_linearised_ = false;
  bool trial_is_predicted_ = false;
  bool is_first_ = false;  // is the next accepted point that where a search begins?
  bool is_last_ = false;   // is the next accepted step the last one?
  bool goes_on_ = false;   // with another trust region, from where the search ended
  bool is_slow_ = false;
  int accepted_ = 0;  // steps
  int iterations_ = 0;
  double initial_cost_ = 0.0;
  double cost_before_ = 0.0;  // kSlowSteps accepted steps ago
};

}  // namespace mindahl::identification
