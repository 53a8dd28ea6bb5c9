#include "identification/solve/solver.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identification/solve/unprojected_residual.h"

namespace mindahl::identification {
namespace {

/// A full step is the last one if it can lower the cost by at most this fraction.
constexpr double kLastStep = 1e-8;

/// n residuals of P coordinates as P + 1 with the same sum of squares, the same JᵀJ and the same
/// Jᵀr: what a least-squares solver learns of them, at a cost that does not grow with n. The first
/// P rows are what the Jacobian's columns explain of the residual, the last is what they do not.
struct CompressedResidual {
  /// Returns by how much a Gauss–Newton step lowers the linearised sum of squares.
  [[nodiscard]] double Explained() const {
    return residual.head(residual.size() - 1).squaredNorm();
  }

  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

/// JᵀJ of unit columns = PᵀLDLᵀP; the rows are √D·Lᵀ·P, and those of the residual √D⁻¹·L⁻¹·P·Jᵀr.
/// @param normal  JᵀJ, from which a rank below P shows as rows of zeros; then Jᵀr and rᵀr
/// @param frozen  true of a coordinate whose column counts as 0
CompressedResidual Compress(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient,
                            double cost, const Eigen::ArrayX<bool>& frozen) {
  // Pivots of unit columns below it are rounding: the direction has no effect.
  constexpr double kNoEffect = 1e-15;
  const Eigen::Index count = gradient.size();
  const Eigen::ArrayXd squares = normal.diagonal();
  const Eigen::VectorXd norms = (!frozen && squares > 0).select(squares.sqrt(), 0.0);
  const Eigen::VectorXd inverse = (norms.array() > 0).select(norms.cwiseInverse(), 0.0);
  const Eigen::LDLT<Eigen::MatrixXd> factors(inverse.asDiagonal() *
                                             (normal * inverse.asDiagonal()));
  const Eigen::ArrayXd pivots = factors.vectorD();
  const Eigen::ArrayXd roots = (pivots > kNoEffect).select(pivots.sqrt(), 0.0);
  const Eigen::PermutationMatrix<Eigen::Dynamic> permutation(factors.transpositionsP());
  Eigen::VectorXd explained = permutation * gradient.cwiseProduct(inverse);
  factors.matrixL().solveInPlace(explained);
  const Eigen::MatrixXd scales = norms.asDiagonal();
  const Eigen::MatrixXd permuted = permutation * scales;
  CompressedResidual compressed{.residual = Eigen::VectorXd::Zero(count + 1),
                                .jacobian = Eigen::MatrixXd::Zero(count + 1, count)};
  compressed.jacobian.topRows(count) = factors.matrixU() * permuted;
  compressed.jacobian.topRows(count).array().colwise() *= roots;
  compressed.residual.head(count) = (roots > 0).select(explained.array() / roots, 0.0);
  compressed.residual[count] = std::sqrt(std::max(cost - compressed.residual.squaredNorm(), 0.0));
  return compressed;
}

/// ceres::TinySolver with what the searches of one start share.
/// TinySolver has neither bounds nor limits of a step, evaluates a trial without its Jacobian, and
/// stops by the absolute change of the cost. Its cost functor therefore
/// - evaluates a coordinate beyond its bound at the bound, where its derivative is 0;
/// - refuses a trial that is too far for its linearisation;
/// - linearises a trial at once, as an accepted one is linearised next;
/// - ends the search by a zero gradient where no step lowers the cost beyond the function
/// tolerance.
class TinySearch {
 public:
  TinySearch(ProjectedResidual& residual, const SolverOptions& options)
      : residual_(residual),
        options_(options),
        count_(std::ssize(residual.searched())),
        lower_(count_),
        upper_(count_) {
    for (Eigen::Index j = 0; j < count_; ++j) {
      lower_[j] = residual.Searched(j).lower;
      upper_[j] = residual.Searched(j).upper;
    }
  }

  /// Searches from u, which it moves; again where the last step was damped too much.
  void Run(Eigen::VectorXd& u) {
    double last_cost = 0.0;
    do {
      last_cost = at_.cost;
      RunOnce(u);
      iterations_ += std::max(tiny_.summary.iterations, 1);
    } while (IsDamped() && at_.cost < last_cost && iterations_ < options_.max_iterations);
  }

  [[nodiscard]] double cost() const { return at_.cost; }
  [[nodiscard]] int iterations() const { return iterations_; }
  /// True if twenty steps together gained next to nothing, and it was left at that.
  [[nodiscard]] bool is_slow() const { return is_slow_; }
  [[nodiscard]] bool has_converged() const {
    return std::isfinite(at_.cost) && tiny_.summary.status != Tiny::HIT_MAX_ITERATIONS;
  }
  /// True if the residual was evaluated where the run ended last.
  [[nodiscard]] bool IsEvaluated() const { return at_.u == trial_.u; }

 private:
  void RunOnce(Eigen::VectorXd& u) {
    constexpr double kLargestRadius = 1e3;
    // TinySolver's gradients are zero or count: cost and gradient have no scale of their own.
    tiny_.options.gradient_tolerance = std::numeric_limits<double>::min();
    tiny_.options.cost_threshold = 0.0;
    tiny_.options.parameter_tolerance = options_.parameter_tolerance;
    tiny_.options.max_num_iterations = options_.max_iterations;
    tiny_.options.initial_trust_region_radius = kLargestRadius;
    is_last_ = is_slow_ = false;
    accepted_ = 0;
    Eigen::VectorXd point = u;
    trial_ = Within(point);
    trial_.cost = residual_.Linearise(trial_.u);
    tiny_.Solve(Function{this}, &point);
    // A step that ends the search is not accepted by a call.
    if (at_.u != Within(point).u) at_ = trial_;
    u = at_.u;
  }

  /// True if the last step gained next to nothing of what was left to gain.
  [[nodiscard]] bool IsDamped() const {
    return tiny_.summary.status == Tiny::COST_CHANGE_TOO_SMALL &&
           compressed_.Explained() > std::max(kLastStep, options_.function_tolerance) * at_.cost;
  }

  struct Function {
    using Scalar = double;
    // NOLINTNEXTLINE(readability-identifier-naming): what TinySolver asks for
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

    [[nodiscard]] int NumParameters() const { return static_cast<int>(search->count_); }
    [[nodiscard]] int NumResiduals() const { return static_cast<int>(search->count_) + 1; }
    bool operator()(const double* x, double* residuals, double* jacobian) const {
      const Eigen::Map<const Eigen::VectorXd> point(x, search->count_);
      Eigen::Map<Eigen::VectorXd> rows(residuals, search->count_ + 1);
      rows.setZero();
      if (jacobian == nullptr) {
        rows[0] = search->Try(point);
      } else {
        search->Accept(point, rows, {jacobian, search->count_ + 1, search->count_});
      }
      return true;
    }

    TinySearch* search;
  };
  using Tiny = ceres::TinySolver<Function>;

  /// Coordinates within their bounds.
  struct Point {
    Eigen::VectorXd u;
    double cost = std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] Point Within(const Eigen::VectorXd& x) const {
    return {.u = x.cwiseMax(lower_).cwiseMin(upper_)};
  }
  /// @returns the root of the cost, or of one by which a trial is refused
  double Try(const Eigen::VectorXd& x) {
    constexpr double kRefused = 1e150;  // ½ of its square is finite, and beyond any finite cost
    // A longer step leads out of what the linearisation of the accepted point says.
    constexpr double kLongest = 1.5;
    constexpr double kOfBounds = 0.25;  // of their distance
    const Eigen::VectorXd longest = (kOfBounds * (upper_ - lower_)).cwiseMin(kLongest);
    const Eigen::VectorXd step = Within(x).u - at_.u;
    if (!x.allFinite() || (step.cwiseAbs().array() > longest.array()).any()) return kRefused;
    trial_ = Within(x);
    trial_.cost = is_last_ ? residual_.Evaluate(trial_.u) : residual_.Linearise(trial_.u);
    // A last step that does not lower the cost could have gained next to nothing: it is refused by
    // less than the function tolerance, which ends the search.
    if (is_last_ && !(trial_.cost < at_.cost)) {
      return std::sqrt(at_.cost * (1 + options_.function_tolerance / 2));
    }
    return std::isfinite(trial_.cost) ? std::sqrt(trial_.cost) : kRefused;
  }

  void Accept(const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> rows,
              Eigen::Map<Eigen::MatrixXd> columns) {
    at_ = trial_;
    columns.setZero();
    rows[count_] = std::sqrt(at_.cost);
    tiny_.options.function_tolerance = options_.function_tolerance * at_.cost;
    if (is_last_) return;  // a zero gradient ends the search
    const Eigen::ArrayXd below = (lower_ - x).array();
    const Eigen::ArrayXd above = (x - upper_).array();
    const auto slope = residual_.gradient().array();
    compressed_ =
        Compress(residual_.normal(), residual_.gradient(), at_.cost,
                 below > 0 || (below == 0 && slope > 0) || above > 0 || (above == 0 && slope < 0));
    constexpr double kSmallestGain = 1e-3;  // of twice the log-likelihood, ...
    constexpr int kSlowSteps = 20;          // ... in as many steps
    const auto samples = static_cast<double>(residual_.problem().data->counted);
    if (accepted_++ % kSlowSteps == 0) {
      const double gain = samples * (cost_before_ - at_.cost);
      is_slow_ = accepted_ > 1 && gain < kSmallestGain * cost_before_;
      cost_before_ = at_.cost;
    }
    const double left = compressed_.Explained();
    if (is_slow_ || left <= options_.function_tolerance * at_.cost) return;
    is_last_ = left <= kLastStep * at_.cost && at_.cost > samples * kRoundingRms * kRoundingRms;
    rows = compressed_.residual;
    columns = compressed_.jacobian;
  }

  ProjectedResidual& residual_;
  const SolverOptions& options_;
  Eigen::Index count_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
  Tiny tiny_;
  Point at_;                       // the accepted one
  Point trial_;                    // the last evaluated one
  CompressedResidual compressed_;  // at the accepted one
  bool is_last_ = false;           // is the next accepted step the last one?
  bool is_slow_ = false;
  int iterations_ = 0;        // of all runs
  int accepted_ = 0;          // points of the last one
  double cost_before_ = 0.0;  // at the last one at which the progress was looked at
};

/// Moves u to the minimum, and returns the solution but for θ.
Solution SearchFrom(Eigen::VectorXd& u, const SolverOptions& options, ProjectedResidual& residual) {
  // A third of the steps is left to the second opinion.
  SolverOptions of_tiny = options;
  if (!options.is_rough) of_tiny.max_iterations -= options.max_iterations / 3;
  TinySearch search(residual, of_tiny);
  search.Run(u);
  double cost = search.cost();
  Solution solution{.converged = search.has_converged()};
  SolverReport& report = solution.report;
  report.solver = "tiny_solver";
  report.iterations = search.iterations();
  report.termination = solution.converged ? "CONVERGENCE" : "NO_CONVERGENCE";
  report.message = !std::isfinite(cost) ? "The residuals at the start are not finite."
                   : solution.converged ? "The search came to its end."
                                        : "The solver made its maximum number of iterations.";
  bool is_evaluated = search.IsEvaluated();
  const auto side_of = [&](Eigen::Index j) { return SideOf(residual.Searched(j), u[j]); };
  bool is_at_bound = false;
  for (Eigen::Index j = 0; j < u.size(); ++j) is_at_bound |= side_of(j) != BoundSide::kInside;
  const int left = options.max_iterations - report.iterations;
  if (!options.is_rough && left > 0 && std::isfinite(cost) &&
      (!solution.converged || search.is_slow() || is_at_bound)) {
    constexpr int kOfOneSearch = 10;  // iterations by Ceres
    SolverOptions within_bounds = options;
    within_bounds.max_iterations = kOfOneSearch * left;
    residual.Evaluate(u);
    Solution within{.theta = residual.Theta(), .report = report};
    SolveByCeres(residual.problem(), Loss::kNone, 1.0, within_bounds, within);
    report = within.report;
    solution.converged = solution.converged || within.converged;
    const Eigen::VectorXd point = residual.SearchedOf(within.theta);
    const double cost_within = residual.Evaluate(point);
    is_evaluated = cost_within < cost;
    if (is_evaluated) {
      u = point;
      cost = cost_within;
    }
  }
  for (Eigen::Index j = 0; j < u.size(); ++j) {  // at a bound is on it
    const BoundSide side = side_of(j);
    if (side == BoundSide::kInside) continue;
    const double bound = residual.Searched(j).BoundOn(side);
    is_evaluated = std::exchange(u[j], bound) == bound && is_evaluated;
  }
  solution.sum_of_squares = is_evaluated ? cost : residual.Evaluate(u);
  return solution;
}

}  // namespace

std::unique_ptr<ceres::LossFunction> LossOf(Loss loss) {
  if (loss == Loss::kHuber) return std::make_unique<ceres::HuberLoss>(1.345);
  if (loss == Loss::kCauchy) return std::make_unique<ceres::CauchyLoss>(2.385);
  if (loss == Loss::kTukey) return std::make_unique<ceres::TukeyLoss>(4.685);
  return nullptr;
}

void SolveByCeres(const Problem& problem, Loss loss, double scale, const SolverOptions& options,
                  Solution& solution) {
  std::vector<double>& theta = solution.theta;
  ceres::Problem ceres_problem;
  const auto block_of = [&](std::size_t p) { return &theta[p]; };
  AddResidualBlock(problem, scale, LossOf(loss), block_of, ceres_problem);
  for (std::size_t p = 0; p < theta.size(); ++p) {
    const Parameter& parameter = problem.parameters[p];
    if (parameter.has_prior()) {
      const Eigen::MatrixXd root =
          Eigen::MatrixXd::Constant(1, 1, parameter.prior_root_weight / scale);
      const Eigen::VectorXd prior = Eigen::VectorXd::Constant(1, parameter.prior_theta);
      ceres_problem.AddResidualBlock(new ceres::NormalPrior(root, prior), nullptr, &theta[p]);
    }
    BoundBlock(&theta[p], parameter.fixed, parameter.lower, parameter.upper, ceres_problem);
  }
  ceres::Solver::Options search;
  search.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  search.max_num_iterations = options.max_iterations;
  search.function_tolerance = options.function_tolerance;
  search.parameter_tolerance = options.parameter_tolerance;
  // The gradient has no scale of its own, so that only one of zero ends a search.
  search.gradient_tolerance = std::numeric_limits<double>::min();
  // Next to a bound Ceres would search along every step, with twenty evaluations or more. Without
  // that its steps end no higher, though they are more.
  search.max_num_line_search_step_size_iterations = 0;
  search.logging_type = ceres::SILENT;
  // Steps that lead nowhere shrink the trust region until it ends the search; that they are many
  // Ceres would print as an error.
  search.max_num_consecutive_invalid_steps = options.max_iterations;
  ceres::Solver::Summary summary;
  ceres::Solve(search, &ceres_problem, &summary);
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  solution.report.solver = "solve";
  solution.report.termination = ceres::TerminationTypeToString(summary.termination_type);
  solution.report.message = summary.message;
  solution.report.iterations += static_cast<int>(summary.iterations.size());
}

Solution Solve(ProjectedResidual& residual, std::span<const double> start,
               const SolverOptions& options) {
  Eigen::VectorXd u = residual.SearchedOf(start);
  Solution solution;
  if (u.size() > 0) {
    solution = SearchFrom(u, options, residual);
  } else {
    solution = {.sum_of_squares = residual.Evaluate(u),
                .converged = true,
                .report = {.termination = "CONVERGENCE",
                           .message = "Every parameter that is not linear is fixed."}};
  }
  solution.theta = residual.Theta();
  solution.converged = solution.converged && std::isfinite(solution.sum_of_squares);
  return solution;
}

}  // namespace mindahl::identification
