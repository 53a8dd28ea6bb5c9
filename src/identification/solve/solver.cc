#include "identification/solve/solver.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identification/solve/projected_residual.h"
#include "identification/solve/unprojected_residual.h"

namespace mindahl::identification {
namespace {

/// A full step is the last one if it can lower the cost by at most this fraction.
constexpr double kLastStep = 1e-8;

/// A residual that refuses a trial: ½ of its square is beyond any cost that is finite, and finite.
constexpr double kRefused = 1e150;

/// n residuals of P coordinates as P + 1 with the same sum of squares, the same JᵀJ and the same
/// Jᵀr: what a least-squares solver learns of them, at a cost that does not grow with n. The first
/// P rows are what the Jacobian's columns explain of the residual, the last is what they do not.
struct CompressedResidual {
  CompressedResidual() = default;

  /// @param normal    JᵀJ, from which a rank below P shows as rows of zeros
  /// @param gradient  Jᵀr
  /// @param cost      rᵀr
  /// @param frozen    1 for a coordinate whose column counts as 0
  CompressedResidual(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient, double cost,
                     std::span<const unsigned char> frozen);

  /// Returns by how much a Gauss–Newton step lowers the linearised sum of squares.
  [[nodiscard]] double Explained() const {
    return residual.head(residual.size() - 1).squaredNorm();
  }

  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

// JᵀJ of unit columns = PᵀLDLᵀP; the rows are √D·Lᵀ·P, and those of the residual √D⁻¹·L⁻¹·P·Jᵀr.
CompressedResidual::CompressedResidual(const Eigen::MatrixXd& normal,
                                       const Eigen::VectorXd& gradient, double cost,
                                       std::span<const unsigned char> frozen) {
  // Pivots of unit columns below it are rounding: the direction has no effect.
  constexpr double kNoEffect = 1e-15;
  const Eigen::Index count = gradient.size();
  Eigen::VectorXd norms(count);
  Eigen::VectorXd slopes = gradient;
  Eigen::MatrixXd correlation = normal;
  for (Eigen::Index j = 0; j < count; ++j) {
    const bool is_frozen = frozen[static_cast<std::size_t>(j)] != 0;
    norms[j] = !is_frozen && normal(j, j) > 0 ? std::sqrt(normal(j, j)) : 0.0;
    const double inverse = norms[j] > 0 ? 1 / norms[j] : 0.0;
    slopes[j] *= inverse;
    correlation.row(j) *= inverse;
    correlation.col(j) *= inverse;
  }
  const Eigen::LDLT<Eigen::MatrixXd> factors(correlation);
  const Eigen::VectorXd pivots = factors.vectorD();
  const Eigen::PermutationMatrix<Eigen::Dynamic> permutation(factors.transpositionsP());
  Eigen::VectorXd explained = permutation * slopes;
  factors.matrixL().solveInPlace(explained);
  const Eigen::MatrixXd scales = norms.asDiagonal();
  const Eigen::MatrixXd permuted = permutation * scales;
  jacobian.setZero(count + 1, count);
  jacobian.topRows(count) = factors.matrixU() * permuted;
  residual.setZero(count + 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double root = pivots[k] > kNoEffect ? std::sqrt(pivots[k]) : 0.0;
    jacobian.row(k) *= root;
    residual[k] = root > 0 ? explained[k] / root : 0.0;
  }
  residual[count] = std::sqrt(std::max(cost - residual.squaredNorm(), 0.0));
}

/// ceres::TinySolver with what the searches of one start share.
///
/// TinySolver has neither bounds nor limits of a step, evaluates a trial without its Jacobian, and
/// stops by the absolute change of the cost. Its cost functor therefore
/// - evaluates a coordinate beyond its bound at the bound, where its derivative is 0;
/// - refuses a trial that is too far for its linearisation;
/// - linearises a trial at once, as an accepted one is linearised next;
/// - reports a zero gradient, which ends the search, where no step can lower the cost by more than
///   the function tolerance.
class TinySearch {
 public:
  TinySearch(ProjectedResidual& residual, const SolverOptions& options)
      : residual_(residual),
        options_(options),
        count_(static_cast<Eigen::Index>(residual.searched().size())),
        floor_(static_cast<double>(residual.problem().data->counted) * kRoundingRms * kRoundingRms),
        clamped_(residual.searched().size()) {}

  /// Searches from u, which it moves.
  void Run(std::span<double> u);

  // Results of the last run.
  [[nodiscard]] double cost() const { return at_.cost; }
  [[nodiscard]] int iterations() const { return std::max(tiny_.summary.iterations, 1); }
  /// True if twenty steps together gained next to nothing, and it was left at that.
  [[nodiscard]] bool is_slow() const { return is_slow_; }
  [[nodiscard]] bool has_converged() const {
    return std::isfinite(at_.cost) && tiny_.summary.status != Tiny::HIT_MAX_ITERATIONS;
  }
  /// True if the last step gained next to nothing of what was left to gain: it was damped too much.
  [[nodiscard]] bool is_damped() const {
    return tiny_.summary.status == Tiny::COST_CHANGE_TOO_SMALL &&
           compressed_.Explained() > std::max(kLastStep, options_.function_tolerance) * at_.cost;
  }
  /// True if the residual was evaluated where the run ended last.
  [[nodiscard]] bool IsEvaluated() const { return at_.u == trial_.u; }

 private:
  struct Function {
    using Scalar = double;
    enum {  // Names that TinySolver asks for.
      // NOLINTNEXTLINE(readability-identifier-naming)
      NUM_RESIDUALS = Eigen::Dynamic,
      // NOLINTNEXTLINE(readability-identifier-naming)
      NUM_PARAMETERS = Eigen::Dynamic
    };

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
    double cost = 0.0;
    bool is_linearised = false;
  };

  [[nodiscard]] Point Within(const Eigen::VectorXd& x) const;
  [[nodiscard]] bool IsTooLong(const Eigen::VectorXd& u) const;
  double Try(const Eigen::VectorXd& x);
  void Accept(const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> rows,
              Eigen::Map<Eigen::MatrixXd> columns);
  void CountAccepted();

  ProjectedResidual& residual_;
  const SolverOptions& options_;
  Eigen::Index count_;
  double floor_;  // of the cost: below it residuals are rounding errors
  Tiny tiny_;
  Point at_;     // the accepted one
  Point trial_;  // the last evaluated one
  std::vector<unsigned char> clamped_;
  CompressedResidual compressed_;  // at the accepted one
  bool is_last_ = false;           // is the next accepted step the last one?
  bool is_slow_ = false;
  int accepted_ = 0;          // points
  double cost_before_ = 0.0;  // kSlowSteps accepted steps ago
};

TinySearch::Point TinySearch::Within(const Eigen::VectorXd& x) const {
  Point point{x};
  for (Eigen::Index j = 0; j < count_; ++j) {
    const Parameter& searched = residual_.Searched(static_cast<std::size_t>(j));
    point.u[j] = std::clamp(x[j], searched.lower, searched.upper);
  }
  return point;
}

/// True if a step from the accepted point to u leads out of what its linearisation says.
bool TinySearch::IsTooLong(const Eigen::VectorXd& u) const {
  constexpr double kLongest = 1.5;
  constexpr double kOfBounds = 0.25;  // of their distance
  for (Eigen::Index j = 0; j < count_; ++j) {
    const Parameter& searched = residual_.Searched(static_cast<std::size_t>(j));
    const double longest = std::min(kLongest, kOfBounds * (searched.upper - searched.lower));
    if (std::abs(u[j] - at_.u[j]) > longest) return true;
  }
  return false;
}

void TinySearch::CountAccepted() {
  constexpr double kSmallestGain = 1e-3;  // of twice the log-likelihood, ...
  constexpr int kSlowSteps = 20;          // ... in as many steps
  const int steps = accepted_++;
  if (steps % kSlowSteps != 0) return;
  const auto samples = static_cast<double>(residual_.problem().data->counted);
  is_slow_ = steps > 0 && samples * (cost_before_ - at_.cost) < kSmallestGain * cost_before_;
  cost_before_ = at_.cost;
}

/// @returns the root of the cost, or of one by which a trial is refused
double TinySearch::Try(const Eigen::VectorXd& x) {
  if (!x.allFinite() || IsTooLong(Within(x).u)) return kRefused;
  trial_ = Within(x);
  const std::span<const double> u(trial_.u.data(), clamped_.size());
  trial_.is_linearised = !is_last_;
  if (!is_last_) {
    trial_.cost = residual_.Linearise(u);
  } else {
    trial_.cost = residual_.Evaluate(u);
    // A last step that does not lower the cost could have gained next to nothing: it is refused by
    // less than the function tolerance, which ends the search.
    if (!(trial_.cost < at_.cost)) {
      return std::sqrt(at_.cost * (1 + options_.function_tolerance / 2));
    }
  }
  return std::isfinite(trial_.cost) ? std::sqrt(trial_.cost) : kRefused;
}

void TinySearch::Accept(const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> rows,
                        Eigen::Map<Eigen::MatrixXd> columns) {
  if (accepted_ == 0) {
    trial_ = Within(x);
    trial_.cost = residual_.Linearise({trial_.u.data(), clamped_.size()});
    trial_.is_linearised = true;
  }
  at_ = trial_;
  columns.setZero();
  rows[count_] = std::sqrt(at_.cost);
  tiny_.options.function_tolerance = options_.function_tolerance * at_.cost;
  if (!at_.is_linearised) return;  // that was the last step: a zero gradient ends the search
  for (Eigen::Index j = 0; j < count_; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const Parameter& searched = residual_.Searched(k);
    const double slope = residual_.gradient()[j];
    const bool below = x[j] <= searched.lower && (x[j] < searched.lower || slope > 0);
    const bool above = x[j] >= searched.upper && (x[j] > searched.upper || slope < 0);
    clamped_[k] = below || above ? 1 : 0;
  }
  compressed_ = CompressedResidual(residual_.normal(), residual_.gradient(), at_.cost, clamped_);
  CountAccepted();
  const double left = compressed_.Explained();
  if (is_slow_ || left <= options_.function_tolerance * at_.cost) return;
  is_last_ = left <= kLastStep * at_.cost && at_.cost > floor_;
  rows = compressed_.residual;
  columns = compressed_.jacobian;
}

void TinySearch::Run(std::span<double> u) {
  constexpr double kLargestRadius = 1e3;
  // TinySolver's gradients are zero or count: cost and gradient have no scale of their own.
  tiny_.options.gradient_tolerance = std::numeric_limits<double>::min();
  tiny_.options.cost_threshold = 0.0;
  tiny_.options.parameter_tolerance = options_.parameter_tolerance;
  tiny_.options.max_num_iterations = options_.max_iterations;
  tiny_.options.initial_trust_region_radius = kLargestRadius;
  is_last_ = is_slow_ = false;
  accepted_ = 0;
  Eigen::VectorXd point = Eigen::Map<const Eigen::VectorXd>(u.data(), count_);
  tiny_.Solve(Function{this}, &point);
  // A step that ends the search is not accepted by a call.
  if (at_.u != Within(point).u) at_ = trial_;
  std::ranges::copy(at_.u, u.begin());
}

bool IsAtBound(const ProjectedResidual& residual, std::span<const double> u) {
  for (std::size_t j = 0; j < u.size(); ++j) {
    if (SideOf(residual.Searched(j), u[j]) != BoundSide::kInside) return true;
  }
  return false;
}

}  // namespace

std::unique_ptr<ceres::LossFunction> LossOf(Loss loss) {
  switch (loss) {
    case Loss::kHuber:
      return std::make_unique<ceres::HuberLoss>(1.345);
    case Loss::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(2.385);
    case Loss::kTukey:
      return std::make_unique<ceres::TukeyLoss>(4.685);
    case Loss::kNone:
      break;
  }
  return nullptr;
}

void SolveByCeres(const Problem& problem, Loss loss, double scale, const SolverOptions& options,
                  Solution& solution) {
  std::vector<double>& theta = solution.theta;
  ceres::Problem ceres_problem;
  std::vector<double*> blocks;
  for (const std::size_t p : UnprojectedResidual::BlocksOf(problem)) blocks.push_back(&theta[p]);
  ceres_problem.AddResidualBlock(new UnprojectedResidual(problem, scale, LossOf(loss)), nullptr,
                                 blocks);
  for (const std::size_t p : problem.parameters.with_prior()) {
    const Parameter& parameter = problem.parameters[p];
    ceres_problem.AddResidualBlock(
        new ceres::NormalPrior(Eigen::MatrixXd::Constant(1, 1, parameter.prior_root_weight / scale),
                               Eigen::VectorXd::Constant(1, parameter.prior_theta)),
        nullptr, &theta[p]);
  }
  for (std::size_t p = 0; p < theta.size(); ++p) {
    const Parameter& parameter = problem.parameters[p];
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

/// Moves u to the minimum.
/// @returns the solution but for θ
Solution Solver::SearchFrom(std::span<double> u, const SolverOptions& options) {
  Solution solution;
  SolverReport& report = solution.report;
  report.solver = "tiny_solver";
  // A third of the steps is left to the second opinion.
  SolverOptions of_tiny = options;
  if (!options.is_rough) of_tiny.max_iterations -= options.max_iterations / 3;
  TinySearch search(residual_, of_tiny);
  double cost = std::numeric_limits<double>::infinity();
  double last_cost = cost;
  do {
    last_cost = cost;
    search.Run(u);
    cost = search.cost();
    report.iterations += search.iterations();
  } while (search.is_damped() && cost < last_cost && report.iterations < of_tiny.max_iterations);
  solution.converged = search.has_converged();
  report.termination = solution.converged ? "CONVERGENCE" : "NO_CONVERGENCE";
  report.message = !std::isfinite(cost) ? "The residuals at the start are not finite."
                   : solution.converged ? "The search came to its end."
                                        : "The solver made its maximum number of iterations.";
  bool is_evaluated = search.IsEvaluated();
  const int left = options.max_iterations - report.iterations;
  if (!options.is_rough && left > 0 && std::isfinite(cost) &&
      (!solution.converged || search.is_slow() || IsAtBound(residual_, u))) {
    constexpr int kOfOneSearch = 10;  // iterations by Ceres
    SolverOptions within_bounds = options;
    within_bounds.max_iterations = kOfOneSearch * left;
    residual_.Evaluate(u);
    Solution within{.theta = residual_.Theta(), .report = report};
    SolveByCeres(residual_.problem(), Loss::kNone, 1.0, within_bounds, within);
    report = within.report;
    solution.converged = solution.converged || within.converged;
    std::vector<double> point;
    for (const std::size_t p : residual_.searched()) point.push_back(within.theta[p]);
    const double cost_within = residual_.Evaluate(point);
    is_evaluated = cost_within < cost;
    if (is_evaluated) {
      std::ranges::copy(point, u.begin());
      cost = cost_within;
    }
  }
  for (std::size_t j = 0; j < u.size(); ++j) {  // at a bound is on it
    const Parameter& searched = residual_.Searched(j);
    const BoundSide side = SideOf(searched, u[j]);
    if (side == BoundSide::kInside) continue;
    const double bound = side == BoundSide::kLower ? searched.lower : searched.upper;
    is_evaluated = std::exchange(u[j], bound) == bound && is_evaluated;
  }
  if (!is_evaluated) cost = residual_.Evaluate(u);
  solution.sum_of_squares = cost;
  return solution;
}

Solution Solver::Solve(std::span<const double> start, const SolverOptions& options) {
  const Parameters& parameters = residual_.problem().parameters;
  Solution solution;
  std::vector<double> u;
  for (const std::size_t p : residual_.searched()) {
    u.push_back(std::clamp(start[p], parameters[p].lower, parameters[p].upper));
  }
  if (u.empty()) {
    solution.sum_of_squares = residual_.Evaluate(u);
    solution.converged = true;
    solution.report.solver = "none";
    solution.report.termination = "CONVERGENCE";
    solution.report.message = "Every parameter that is not linear is fixed.";
  } else {
    solution = SearchFrom(u, options);
  }
  solution.theta = residual_.Theta();
  solution.report.final_cost = solution.sum_of_squares / 2;
  solution.converged = solution.converged && std::isfinite(solution.sum_of_squares);
  return solution;
}

}  // namespace mindahl::identification
