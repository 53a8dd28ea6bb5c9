#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "identification/problem/problem.h"

namespace mindahl::identification {

struct SolverOptions {
  double function_tolerance = 1e-10;
  double parameter_tolerance = 1e-13;
  int max_iterations = 500;
  /// Of the cost: a full step from where no more can be gained is the last.
  double last_step = 1e-6;
  /// By the parabola's word: the cost where it ends is not looked at, though it is moved to.
  bool predicts_last = false;
};

struct Solution {
  std::vector<double> theta;    // of all parameters
  std::vector<BoundSide> side;  // of all parameters
  double sum_of_squares = 0.0;  // weighted
  std::vector<double> residual;  // weighted, model − measured; none where the end was not looked at
  bool converged = false;
  int iterations = 0;
  std::string_view termination = "not run";
};

/// Least squares by variable projection: Tc and all parameters with a column of their own are
/// eliminated at every point, and the others searched by Levenberg and Marquardt's method within
/// their bounds, with Kaufman's Jacobian (Golub & Pereyra 2003, section 3): the derivatives of t,
/// freed from what the eliminated columns explain.
///
/// Tc is eliminated where t is searched over σ/Tc (and Tc/k of a rig). Where the user holds or
/// bounds σ or k themselves, these and Tc are searched instead. Of a displacement Tc is searched
/// and its factor Tc/σ eliminated, unless the user holds or bounds σ. A bound on an eliminated
/// column's factor holds it there once it is passed.
///
/// Keeps its buffers; nothing is allocated once they are large enough.
class Solver {
 public:
  /// @param problem   must outlive the solves; its weights may change between them
  /// @param response  bound to the problem here
  void Bind(const Problem& problem, Response& response);

  /// Moves a parameter that the problem holds, of those without a column of their own.
  void HoldAt(std::size_t parameter, double theta) { held_theta_[parameter] = theta; }

  /// Least cost at the searched parameters of θ: writes the eliminated ones into θ.
  /// @returns Σ of the squared weighted residuals
  double CostAt(std::span<double> theta);

  /// The same with the factor of t eliminated whatever is held, for looks at the plane of σ/Tc, or
  /// of a displacement of Tc, and α.
  /// @returns infinity where the regression has the wrong sign; else σ or Tc in θ
  double CostAt(const LawPoint& at, std::span<double> theta);

  /// @param start  θ, moved into the bounds
  void Solve(std::span<const double> start, const SolverOptions& options, Solution& solution);

 private:
  enum class Role {
    kLogRate,
    kLogTravel,
    kShapeExponent,
    kUnloaded,
    kLag,
    kAsymmetry,
    kLogStiffness,
    kLogSlipForce,
    kLogRig,
    kExponentOfLoad
  };
  struct Searched {
    Role role;
    std::size_t parameter;
    double lower;
    double upper;
  };
  struct Column {  // of a linear parameter, orthonormal to those before
    std::size_t parameter;
    std::size_t begin;  // rows beyond which it is 0
    std::size_t end;
    double diagonal;  // of R; 0 where it depends on those before
  };

  void ChooseSearched();
  void SearchTheOthers();
  void OrthogonaliseColumns();
  [[nodiscard]] bool Searches(Role role) const;
  /// Does the response read it from θ, not from the point of the law?
  [[nodiscard]] static bool IsOfThePath(Role role) {
    return role == Role::kUnloaded || role == Role::kLag || role == Role::kAsymmetry;
  }
  [[nodiscard]] LawPoint PointOf(std::span<const double> u) const;
  void Load(std::span<const double> theta, std::span<double> u);
  void Store(std::span<const double> u, std::span<double> theta) const;
  void StoreLinear(double scale, std::span<double> theta) const;
  [[nodiscard]] std::pair<double, double> BoundsOfScale(double log_rate) const;
  double Regress(double log_rate, bool is_free, double held_scale);
  void Linearise(std::span<const double> u);
  double Evaluate(std::span<const double> u, bool with_gradient);
  void DifferentiateForced(const LawPoint& point);
  void SplitByRecord(std::span<const double> all);
  void FillLoadExponent(std::span<const double> by_log_rate);
  [[nodiscard]] std::pair<std::size_t, std::size_t> RowsOf(std::size_t record) const;
  void ProjectOut(std::span<double> column) const;
  bool Step(double damping, std::span<const unsigned char> frozen, std::span<double> step) const;
  [[nodiscard]] double Predicted(std::span<const double> step) const;
  void Search(std::span<double> u, const SolverOptions& options, Solution& solution);
  void MarkSides(std::span<const double> u, Solution& solution) const;

  std::span<double> Basis(std::size_t k) { return {basis_.data() + k * samples_, samples_}; }
  std::span<const double> Basis(std::size_t k) const {
    return {basis_.data() + k * samples_, samples_};
  }
  std::span<double> Derivative(std::size_t k) {
    return {derivatives_.data() + k * samples_, samples_};
  }

  [[nodiscard]] bool is_forced() const { return problem_->data->is_forced(); }

  const Problem* problem_ = nullptr;
  Response* response_ = nullptr;
  std::size_t samples_ = 0;
  std::vector<Searched> searched_;
  std::vector<unsigned char> held_;  // linear parameters held at a bound
  std::vector<double> held_theta_;   // θ of what is not searched
  std::vector<Column> columns_;
  std::vector<double> basis_;                 // orthonormal columns
  std::vector<double> triangle_;              // R, columns_.size()², by rows
  std::vector<double> measured_projections_;  // Qᵀy
  std::vector<double> response_projections_;
  std::vector<double> derivatives_;  // of the residual by what is searched, projected
  std::vector<double> of_samples_;   // that the next four are in
  std::span<double> measured_;       // y, weighted, projected
  std::span<double> weight_;
  std::span<double> response_values_;  // t, weighted, projected
  std::span<double> residual_;         // projected
  double scale_ = 0.0;                 // of t: Tc, or Tc/σ of a displacement
  bool scale_is_free_ = false;         // of its bounds
  bool scale_is_linear_ = false;
  std::vector<double> hessian_;
  std::vector<double> gradient_;
  mutable std::vector<double> matrix_;
  std::vector<double> step_;
  std::vector<double> trial_;
  std::vector<double> u_;
  std::vector<unsigned char> frozen_;
};

}  // namespace mindahl::identification
