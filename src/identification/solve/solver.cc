#include "identification/solve/solver.h"

#include <ceres/ceres.h>
#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/solve/projected_residual.h"

namespace mindahl::identification {
ceres::Solver::Options CeresOptionsOf(const SolverOptions& options,
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

namespace {

/// ceres::Solve sees the same compressed residual, with its Jacobian at every point.
class CompressedCost final : public ceres::CostFunction {
 public:
  CompressedCost(ProjectedResidual& residual, std::size_t count) : residual_(residual) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(count));
    set_num_residuals(static_cast<int>(count) + 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const auto count = static_cast<std::size_t>(parameter_block_sizes().front());
    const bool with_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    const std::span<const double> u(parameters[0], count);
    const double cost = with_jacobian ? residual_.Linearise(u) : residual_.Evaluate(u);
    Eigen::Map<Eigen::VectorXd> rows(residuals, num_residuals());
    rows.setZero();
    rows[0] = std::isfinite(cost) ? std::sqrt(cost) : kRefused;
    if (!with_jacobian || !std::isfinite(cost)) return std::isfinite(cost) || !with_jacobian;
    const CompressedResidual compressed(residual_.normal(), residual_.gradient(), cost, {});
    rows = compressed.residual;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor> jacobian(jacobians[0], rows.size(), static_cast<Eigen::Index>(count));
    jacobian = compressed.jacobian;
    return rows.allFinite() && jacobian.allFinite();  // Ceres would print what is not
  }

 private:
  ProjectedResidual& residual_;
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
  TinySearch(ProjectedResidual& residual, const SolverOptions& options)
      : residual_(residual),
        options_(options),
        count_(residual.searched().size()),
        floor_(static_cast<double>(residual.problem().data->counted) * kRoundingRms * kRoundingRms),
        at_(count_),
        raw_(count_),
        trial_(count_),
        clamped_(count_) {}

  /// Searches from u, which it moves.
  void Run(std::span<double> u);

  /// Linearises at u, where the next run begins.
  void LineariseAt(std::span<const double> u) {
    trial_.assign(u.begin(), u.end());
    trial_cost_ = residual_.Linearise(u);
    trial_is_linearised_ = true;
  }

  // Results of the last run.
  [[nodiscard]] double cost() const { return cost_; }
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] bool hit_maximum() const {
    return tiny_.summary.status == Tiny::HIT_MAX_ITERATIONS;
  }
  /// True if twenty steps together gained next to nothing, and it was left at that.
  [[nodiscard]] bool is_slow() const { return is_slow_; }
  [[nodiscard]] const char* Message() const;
  /// True if the residual was evaluated, or predicted, at u last.
  [[nodiscard]] bool IsEvaluatedAt(std::span<const double> u) const {
    return std::ranges::equal(u, trial_);
  }

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
      if (jacobian == nullptr) {
        search->Try(x, residuals);
      } else {
        search->Accept(x, residuals, jacobian);
      }
      return true;
    }

    TinySearch* search;
  };
  using Tiny = ceres::TinySolver<Function>;

  void Try(const double* x, double* residuals);
  void Accept(const double* x, double* residuals, double* jacobian);
  /// A residual that refuses a trial by less than the function tolerance, which ends the search.
  [[nodiscard]] double EndOfSearch() const {
    return std::sqrt(cost_ * (1 + options_.function_tolerance / 2));
  }
  void Clamp(const double* x, std::vector<double>& to) const;
  [[nodiscard]] bool IsTooLong(std::size_t j, double step) const;
  void FindClamped(const double* x);
  void CountAccepted();

  ProjectedResidual& residual_;
  const SolverOptions& options_;
  std::size_t count_;
  double floor_;               // of the cost: below it residuals are rounding errors
  std::vector<double> at_;     // accepted coordinates, within their bounds
  std::vector<double> raw_;    // as TinySolver has them
  std::vector<double> trial_;  // the last evaluated ones
  std::vector<unsigned char> clamped_;
  Tiny tiny_;
  CompressedResidual compressed_;  // at the accepted coordinates
  double cost_ = 0.0;              // there
  double trial_cost_ = 0.0;
  bool trial_is_linearised_ = false;
  bool is_first_ = false;  // is the next accepted point that where a search begins?
  bool is_last_ = false;   // is the next accepted step the last one?
  bool goes_on_ = false;   // with another trust region, from where the search ended
  bool is_slow_ = false;
  int accepted_ = 0;  // steps
  int iterations_ = 0;
  double cost_before_ = 0.0;  // kSlowSteps accepted steps ago
};

void TinySearch::Clamp(const double* x, std::vector<double>& to) const {
  const std::span<const SearchedParameter> searched = residual_.searched();
  for (std::size_t j = 0; j < count_; ++j) {
    to[j] = std::clamp(x[j], searched[j].lower, searched[j].upper);
  }
}

bool TinySearch::IsTooLong(std::size_t j, double step) const {
  const std::size_t p = residual_.searched()[j].parameter;
  const double unit = p == kShape ? std::max(1.0, raw_[j]) : 1.0;
  return std::abs(step) > residual_.problem().parameters[p].term->longest_step * unit;
}

void TinySearch::FindClamped(const double* x) {
  const std::span<const SearchedParameter> searched = residual_.searched();
  for (std::size_t j = 0; j < count_; ++j) {
    const double slope = residual_.gradient()[static_cast<Eigen::Index>(j)];
    const bool below = x[j] <= searched[j].lower && (x[j] < searched[j].lower || slope > 0);
    const bool above = x[j] >= searched[j].upper && (x[j] > searched[j].upper || slope < 0);
    clamped_[j] = below || above ? 1 : 0;
  }
}

void TinySearch::CountAccepted() {
  constexpr double kSmallestGain = 1e-3;  // of twice the log-likelihood, ...
  constexpr int kSlowSteps = 20;          // ... in as many steps
  if (!is_first_) ++accepted_;
  if (accepted_ == 0) cost_before_ = cost_;
  if (is_first_ || accepted_ % kSlowSteps != 0) return;
  const auto samples = static_cast<double>(residual_.problem().data->counted);
  is_slow_ = samples * (cost_before_ - cost_) < kSmallestGain * cost_before_;
  cost_before_ = cost_;
}

void TinySearch::Try(const double* x, double* residuals) {
  const auto size = static_cast<Eigen::Index>(count_);
  Eigen::Map<Eigen::VectorXd> rows(residuals, size + 1);
  rows.setZero();
  bool is_number = true;
  for (std::size_t j = 0; j < count_; ++j) {
    is_number = is_number && std::isfinite(x[j]);
    goes_on_ = goes_on_ || IsTooLong(j, x[j] - raw_[j]);
  }
  if (!is_number || goes_on_) {
    rows[0] = goes_on_ ? EndOfSearch() : kRefused;
    return;
  }
  Clamp(x, trial_);
  trial_is_linearised_ = !is_last_;
  if (is_last_ && options_.predicts_last) {
    const Eigen::VectorXd step = Eigen::Map<const Eigen::VectorXd>(trial_.data(), size) -
                                 Eigen::Map<const Eigen::VectorXd>(at_.data(), size);
    trial_cost_ = (compressed_.residual + compressed_.jacobian * step).squaredNorm();
  } else {
    trial_cost_ = is_last_ ? residual_.Evaluate(trial_) : residual_.Linearise(trial_);
    // A last step that does not lower the cost could have gained next to nothing.
    if (is_last_ && !(trial_cost_ < cost_)) {
      rows[0] = EndOfSearch();
      return;
    }
  }
  rows[0] = std::isfinite(trial_cost_) ? std::sqrt(trial_cost_) : kRefused;
}

void TinySearch::Accept(const double* x, double* residuals, double* jacobian) {
  const auto size = static_cast<Eigen::Index>(count_);
  Eigen::Map<Eigen::VectorXd> rows(residuals, size + 1);
  Eigen::Map<Eigen::MatrixXd> columns(jacobian, size + 1, size);
  Clamp(x, at_);
  if (is_first_ && !(trial_is_linearised_ && trial_ == at_)) {
    LineariseAt(at_);
  }
  raw_.assign(x, x + count_);
  cost_ = trial_cost_;
  rows.setZero();
  columns.setZero();
  rows[size] = std::sqrt(cost_);
  tiny_.options.function_tolerance = options_.function_tolerance * cost_;
  if (!trial_is_linearised_) return;  // that was the last step: a zero gradient ends the search
  FindClamped(x);
  compressed_ = CompressedResidual(residual_.normal(), residual_.gradient(), cost_, clamped_);
  CountAccepted();
  const double left = compressed_.Explained();
  if (is_slow_ || left <= options_.function_tolerance * cost_) return;
  is_last_ = left <= options_.last_step * cost_ && cost_ > floor_;
  is_first_ = false;
  rows = compressed_.residual;
  columns = compressed_.jacobian;
}

void TinySearch::Run(std::span<double> u) {
  // TinySolver's gradients are zero or count: cost and gradient have no scale of their own.
  constexpr double kOnlyZero = std::numeric_limits<double>::min();
  // A search that ends with more than this fraction of the cost to gain was damped too much.
  constexpr double kGainWorthGoingOn = 1e-6;
  constexpr double kLargestRadius = 1e3;
  tiny_.options.gradient_tolerance = kOnlyZero;
  tiny_.options.cost_threshold = 0.0;
  tiny_.options.parameter_tolerance = options_.parameter_tolerance;
  accepted_ = iterations_ = 0;
  is_slow_ = false;
  Eigen::VectorXd point =
      Eigen::Map<const Eigen::VectorXd>(u.data(), static_cast<Eigen::Index>(u.size()));
  double last_cost = std::numeric_limits<double>::infinity();
  double radius = kLargestRadius;
  do {
    is_first_ = true;
    is_last_ = goes_on_ = false;
    tiny_.options.max_num_iterations = options_.max_iterations - iterations_;
    tiny_.options.initial_trust_region_radius = radius;
    tiny_.Solve(Function{this}, &point);
    // A first step that is too long costs no evaluation.
    const bool is_first_too_long = goes_on_ && tiny_.summary.iterations <= 1;
    radius = is_first_too_long ? radius / 4 : kLargestRadius;
    if (is_first_too_long) continue;
    iterations_ += std::max(tiny_.summary.iterations, 1);
    // A step that ends the search is not accepted by a call.
    if (!std::equal(raw_.begin(), raw_.end(), point.data())) {
      at_ = trial_;
      cost_ = trial_cost_;
    }
    const bool was_damped = tiny_.summary.status == Tiny::COST_CHANGE_TOO_SMALL &&
                            cost_ < last_cost &&
                            compressed_.Explained() > kGainWorthGoingOn * cost_;
    goes_on_ = goes_on_ || was_damped;
    last_cost = cost_;
  } while (goes_on_ && iterations_ < options_.max_iterations);
  std::ranges::copy(at_, u.begin());
}

const char* TinySearch::Message() const {
  if (!std::isfinite(cost_)) return "The residuals at the start are not finite.";
  if (is_slow_) return "Twenty steps together raised twice the log-likelihood by less than 1e-3.";
  switch (tiny_.summary.status) {
    case Tiny::GRADIENT_TOO_SMALL:
      return "No step can lower the cost by more than the function tolerance.";
    case Tiny::RELATIVE_STEP_SIZE_TOO_SMALL:
      return "No parameter moves by more than the parameter tolerance.";
    case Tiny::COST_TOO_SMALL:
      return "The cost is zero.";
    case Tiny::COST_CHANGE_TOO_SMALL:
      return "The last step changed the cost by less than the function tolerance.";
    case Tiny::HIT_MAX_ITERATIONS:
      break;
  }
  return "The solver made its maximum number of iterations.";
}

/// True if a coordinate that lies at one of its bounds would lower the cost on its way back.
bool LeadsInward(const ProjectedResidual& residual, std::span<const double> u, double tolerance) {
  std::vector<unsigned char> others(u.size());
  bool any = false;
  for (std::size_t j = 0; j < u.size(); ++j) {
    const SearchedParameter& searched = residual.searched()[j];
    const double slope = residual.gradient()[static_cast<Eigen::Index>(j)];
    const bool inward =
        (u[j] <= searched.lower && slope < 0) || (u[j] >= searched.upper && slope > 0);
    others[j] = inward ? 0 : 1;
    any = any || inward;
  }
  if (!any) return false;
  const CompressedResidual compressed(residual.normal(), residual.gradient(), 0.0, others);
  return compressed.Explained() > tolerance;
}

bool IsAtBound(const ProjectedResidual& residual, std::span<const double> u) {
  for (std::size_t j = 0; j < u.size(); ++j) {
    const SearchedParameter& searched = residual.searched()[j];
    if (SideOf(u[j], searched.lower, searched.upper) != BoundSide::kInside) return true;
  }
  return false;
}

/// Searches by ceres::Solve within the bounds, from u, which it moves.
ceres::Solver::Summary SolveWithinBounds(ProjectedResidual& residual, const SolverOptions& options,
                                         int max_iterations, std::span<double> u) {
  CompressedCost cost(residual, u.size());
  ceres::Problem::Options of_problem;
  of_problem.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(of_problem);
  problem.AddResidualBlock(&cost, nullptr, u.data());
  for (std::size_t j = 0; j < u.size(); ++j) {
    const SearchedParameter& searched = residual.searched()[j];
    problem.SetParameterLowerBound(u.data(), static_cast<int>(j), searched.lower);
    problem.SetParameterUpperBound(u.data(), static_cast<int>(j), searched.upper);
  }
  ceres::Solver::Options search = CeresOptionsOf(options, ceres::DENSE_QR);
  // Next to a bound Ceres would search along every step, with twenty evaluations or more. Without
  // that its steps end no higher, though they are more.
  constexpr int kOfOneSearch = 3;
  search.max_num_line_search_step_size_iterations = 0;
  search.max_num_iterations = kOfOneSearch * max_iterations;
  ceres::Solver::Summary summary;
  ceres::Solve(search, &problem, &summary);
  return summary;
}

}  // namespace

void Solver::SearchFrom(std::span<double> u, const SolverOptions& options, Solution& solution) {
  SolverReport& report = solution.report;
  report.solver = "tiny_solver";
  // A third of the steps is left to the second opinion.
  SolverOptions of_tiny = options;
  if (!options.is_rough) of_tiny.max_iterations -= options.max_iterations / 3;
  TinySearch search(residual_, of_tiny);
  double last_cost = std::numeric_limits<double>::infinity();
  // Each pass lets go what lies at a bound and leads inward.
  for (std::size_t pass = 0; pass <= u.size(); ++pass) {
    search.Run(u);
    report.iterations += search.iterations();
    const bool is_lower = search.cost() < last_cost;
    last_cost = search.cost();
    if (!is_lower || !IsAtBound(residual_, u)) break;
    search.LineariseAt(u);
    if (!LeadsInward(residual_, u, options.function_tolerance * search.cost())) break;
  }
  double cost = search.cost();
  solution.converged = !search.hit_maximum() && std::isfinite(cost);
  report.termination = solution.converged ? "CONVERGENCE" : "NO_CONVERGENCE";
  report.message = search.Message();
  bool is_evaluated = search.IsEvaluatedAt(u);
  const int left = options.max_iterations - report.iterations;
  if (!options.is_rough && left > 0 && std::isfinite(cost) &&
      (!solution.converged || search.is_slow() || IsAtBound(residual_, u))) {
    std::vector<double> within(u.begin(), u.end());
    const ceres::Solver::Summary summary = SolveWithinBounds(residual_, options, left, within);
    report.solver = "solve";
    report.iterations += static_cast<int>(summary.iterations.size());
    report.termination = ceres::TerminationTypeToString(summary.termination_type);
    report.message = summary.message;
    solution.converged = solution.converged || summary.termination_type == ceres::CONVERGENCE;
    if (summary.IsSolutionUsable() && 2 * summary.final_cost < cost) {
      std::ranges::copy(within, u.begin());
      cost = 2 * summary.final_cost;
    }
    is_evaluated = false;
  }
  if (!is_evaluated) cost = residual_.Evaluate(u);
  solution.sum_of_squares = cost;
}

void Solver::MarkSides(std::span<const double> u, Solution& solution) const {
  const Problem& problem = residual_.problem();
  const Parameters& parameters = problem.parameters;
  const bool is_forced = problem.data->is_forced();
  solution.side.assign(parameters.size(), BoundSide::kInside);
  for (const std::size_t p : parameters.free()) {
    const bool is_eliminated =
        residual_.scale_is_linear() && !is_forced && (p == kStiffness || p == kRig);
    if (!is_eliminated) solution.side[p] = SideOf(parameters[p], solution.theta[p]);
  }
  for (std::size_t j = 0; j < u.size(); ++j) {
    const SearchedParameter& s = residual_.searched()[j];
    const BoundSide side = SideOf(u[j], s.lower, s.upper);
    if (is_forced && s.parameter == kSlipForce) solution.side[kSlipForce] = side;
    if (s.eliminated == &LawPoint::log_rate && side == BoundSide::kUpper) {
      solution.side[kStiffness] = side;
    }
    if (s.eliminated == &LawPoint::log_rate && side == BoundSide::kLower) {
      solution.side[kSlipForce] = BoundSide::kUpper;  // a straight line
    }
    if (s.eliminated == &LawPoint::log_travel && side != BoundSide::kInside) {
      solution.side[kRig] = side == BoundSide::kLower ? BoundSide::kUpper : BoundSide::kLower;
    }
  }
}

void Solver::Solve(std::span<const double> start, const SolverOptions& options,
                   Solution& solution) {
  const Parameters& parameters = residual_.problem().parameters;
  solution.theta.assign(residual_.theta().begin(), residual_.theta().end());
  solution.report.iterations = 0;
  residual_.ReleaseLinear();
  u_.resize(residual_.searched().size());
  residual_.Load(start, u_);
  // Each pass holds one more linear parameter at the bound that it had passed.
  for (std::size_t pass = 0; pass <= parameters.size(); ++pass) {
    if (u_.empty()) {
      solution.sum_of_squares = residual_.Evaluate(u_);
      solution.converged = std::isfinite(solution.sum_of_squares);
      solution.report.solver = "none";
      solution.report.termination = "CONVERGENCE";
      solution.report.message = parameters.free().empty()
                                    ? "every parameter is fixed"
                                    : "Every parameter that is not linear is fixed.";
    } else {
      SearchFrom(u_, options, solution);
    }
    residual_.Store(u_, solution.theta);
    if (!residual_.HoldPassed(solution.theta)) break;
  }
  solution.report.final_cost = solution.sum_of_squares / 2;
  solution.converged = solution.converged && std::isfinite(solution.sum_of_squares);
  MarkSides(u_, solution);
}

}  // namespace mindahl::identification
