#include "identification/solve/solver.h"

#include <ceres/ceres.h>
#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/solve/ceres_options.h"
#include "identification/solve/compressed_residual.h"

namespace mindahl::identification {
namespace {

/// ½ of its square is beyond any cost that is finite, and finite itself.
constexpr double kRefused = 1e150;

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
    rows = compressed.residual();
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(jacobians[0], rows.size(), static_cast<Eigen::Index>(count)) =
        compressed.jacobian();
    return true;
  }

 private:
  ProjectedResidual& residual_;
};

}  // namespace

/// The cost functor of ceres::TinySolver, and what the searches of one start share.
///
/// TinySolver has neither bounds nor limits of a step, evaluates a trial without its Jacobian, and
/// stops by the absolute change of the cost. The functor therefore
/// - evaluates a coordinate beyond its bound at the bound, where its derivative is 0;
/// - ends the search where a trial moves a coordinate further than one step may, and goes on with
///   a trust region in which it does not;
/// - linearises a trial at once, as an accepted one is linearised next;
/// - reports a zero gradient, which ends the search, where no step can lower the cost by more than
///   the function tolerance.
struct Solver::Search {
  struct Function {
    using Scalar = double;
    // Names that TinySolver asks for. NOLINTNEXTLINE(readability-identifier-naming)
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

    [[nodiscard]] int NumParameters() const { return static_cast<int>(search->count); }
    [[nodiscard]] int NumResiduals() const { return static_cast<int>(search->count) + 1; }
    bool operator()(const double* x, double* residuals, double* jacobian) const {
      if (jacobian == nullptr) {
        search->Try(x, residuals);
      } else {
        search->Accept(x, residuals, jacobian);
      }
      return true;
    }

    Search* search;
  };
  using TinySolver = ceres::TinySolver<Function>;

  void Start(ProjectedResidual& of, const SolverOptions& with, double rounding);
  void Run(std::span<double> u);
  [[nodiscard]] const char* Message() const;
  void Try(const double* x, double* residuals);
  void Accept(const double* x, double* residuals, double* jacobian);

  /// A residual that refuses a trial by less than the function tolerance, which ends the search.
  [[nodiscard]] double EndOfSearch() const {
    return std::sqrt(cost * (1 + options.function_tolerance / 2));
  }
  void Clamp(const double* x, std::vector<double>& to) const;
  [[nodiscard]] bool IsTooLong(std::size_t j, double step) const;
  [[nodiscard]] double RadiusOfFirstStep() const;

  ProjectedResidual* residual = nullptr;
  SolverOptions options;
  std::size_t count = 0;
  double floor = 0.0;  // of the cost: below it residuals are rounding errors
  TinySolver tiny;
  TinySolver::Parameters point;
  std::vector<double> at;     // accepted coordinates, within their bounds
  std::vector<double> raw;    // as TinySolver has them
  std::vector<double> trial;  // the last evaluated ones
  std::vector<unsigned char> clamped;
  double cost = 0.0;  // there
  double trial_cost = 0.0;
  bool trial_is_linearised = false;
  bool trial_is_predicted = false;
  bool is_first = false;  // is the next accepted point that where a search begins?
  bool is_last = false;   // is the next accepted step the last one?
  bool goes_on = false;   // with another trust region, from where the search ended
  bool is_slow = false;
  int accepted = 0;  // steps
  int iterations = 0;
  double initial_cost = 0.0;
  double cost_before = 0.0;  // kSlowSteps accepted steps ago
  CompressedResidual compressed;
};

void Solver::Search::Start(ProjectedResidual& of, const SolverOptions& with, double rounding) {
  residual = &of;
  options = with;
  count = of.searched().size();
  floor = rounding;
  trial_is_linearised = trial_is_predicted = false;
  clamped.assign(count, 0);
  at.resize(count);
  raw.resize(count);
  trial.resize(count);
}

void Solver::Search::Clamp(const double* x, std::vector<double>& to) const {
  const std::span<const SearchedParameter> searched = residual->searched();
  for (std::size_t j = 0; j < count; ++j) {
    to[j] = std::clamp(x[j], searched[j].lower, searched[j].upper);
  }
}

bool Solver::Search::IsTooLong(std::size_t j, double step) const {
  const LawSensitivity& sensitivity = residual->searched()[j].sensitivity;
  const double limit =
      sensitivity.longest_step * (sensitivity.step_grows_with_theta ? std::max(1.0, raw[j]) : 1.0);
  return std::abs(step) > limit;
}

/// Returns the largest radius, of those tried, with which TinySolver's first step is not too long.
double Solver::Search::RadiusOfFirstStep() const {
  constexpr double kLargestRadius = 1e3;
  constexpr int kTries = 40;
  // TinySolver scales the columns, and keeps the damping of those without effect from vanishing.
  constexpr double kLeastDiagonal = 1e-6;
  const Eigen::VectorXd scaling = 1 / (1 + compressed.jacobian().colwise().norm().array());
  const Eigen::MatrixXd jacobian = compressed.jacobian() * scaling.asDiagonal();
  const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  const Eigen::VectorXd gradient = jacobian.transpose() * compressed.residual();
  double radius = kLargestRadius;
  for (int tries = 0; tries < kTries; ++tries, radius /= 4) {
    Eigen::MatrixXd damped = normal;
    damped.diagonal() += normal.diagonal().cwiseMax(kLeastDiagonal) / radius;
    const Eigen::VectorXd step = -scaling.cwiseProduct(damped.ldlt().solve(gradient));
    bool is_short = true;
    for (std::size_t j = 0; j < count; ++j) {
      is_short = is_short && !IsTooLong(j, step[static_cast<Eigen::Index>(j)]);
    }
    if (is_short) break;
  }
  return radius;
}

void Solver::Search::Try(const double* x, double* residuals) {
  Eigen::Map<Eigen::VectorXd> rows(residuals, static_cast<Eigen::Index>(count) + 1);
  rows.setZero();
  bool is_number = true;
  for (std::size_t j = 0; j < count; ++j) {
    is_number = is_number && std::isfinite(x[j]);
    goes_on = goes_on || IsTooLong(j, x[j] - raw[j]);
  }
  if (!is_number || goes_on) {
    rows[0] = goes_on ? EndOfSearch() : kRefused;
    return;
  }
  Clamp(x, trial);
  trial_is_linearised = !is_last;
  trial_is_predicted = is_last && options.predicts_last;
  if (trial_is_predicted) {
    Eigen::VectorXd step(static_cast<Eigen::Index>(count));
    for (std::size_t j = 0; j < count; ++j) {
      step[static_cast<Eigen::Index>(j)] = trial[j] - at[j];
    }
    trial_cost = (compressed.residual() + compressed.jacobian() * step).squaredNorm();
  } else {
    trial_cost = is_last ? residual->Evaluate(trial) : residual->Linearise(trial);
    // A last step that does not lower the cost could have gained next to nothing.
    if (is_last && !(trial_cost < cost)) {
      rows[0] = EndOfSearch();
      return;
    }
  }
  rows[0] = std::isfinite(trial_cost) ? std::sqrt(trial_cost) : kRefused;
}

void Solver::Search::Accept(const double* x, double* residuals, double* jacobian) {
  constexpr double kSmallestGain = 1e-3;  // of twice the log-likelihood, ...
  constexpr int kSlowSteps = 20;          // ... in as many steps
  const auto size = static_cast<Eigen::Index>(count);
  Eigen::Map<Eigen::VectorXd> rows(residuals, size + 1);
  Eigen::Map<Eigen::MatrixXd> columns(jacobian, size + 1, size);
  const std::span<const SearchedParameter> searched = residual->searched();
  Clamp(x, at);
  if (is_first && !(trial_is_linearised && trial == at)) {
    trial = at;
    trial_cost = residual->Linearise(trial);
    trial_is_linearised = true;
    trial_is_predicted = false;
  }
  raw.assign(x, x + count);
  cost = trial_cost;
  rows.setZero();
  columns.setZero();
  rows[size] = std::sqrt(cost);
  tiny.options.function_tolerance = options.function_tolerance * cost;
  if (!trial_is_linearised) return;  // that was the last step: a zero gradient ends the search
  if (!is_first) ++accepted;
  for (std::size_t j = 0; j < count; ++j) {
    const double slope = residual->gradient()[static_cast<Eigen::Index>(j)];
    const bool below = x[j] <= searched[j].lower && (x[j] < searched[j].lower || slope > 0);
    const bool above = x[j] >= searched[j].upper && (x[j] > searched[j].upper || slope < 0);
    clamped[j] = below || above ? 1 : 0;
  }
  compressed = CompressedResidual(residual->normal(), residual->gradient(), cost, clamped);
  if (accepted == 0) cost_before = cost;
  if (!is_first && accepted % kSlowSteps == 0) {
    const auto samples = static_cast<double>(residual->problem().data->counted);
    is_slow = samples * (cost_before - cost) < kSmallestGain * cost_before;
    cost_before = cost;
  }
  const double left = compressed.Explained();
  if (is_slow || left <= options.function_tolerance * cost) return;
  is_last = left <= options.last_step * cost && cost > floor;
  if (is_first) tiny.options.initial_trust_region_radius = RadiusOfFirstStep();
  is_first = false;
  rows = compressed.residual();
  columns = compressed.jacobian();
}

void Solver::Search::Run(std::span<double> u) {
  // TinySolver's gradients are zero or count: cost and gradient have no scale of their own.
  constexpr double kOnlyZero = std::numeric_limits<double>::min();
  // A search that ends with more than this fraction of the cost to gain was damped too much.
  constexpr double kGainWorthGoingOn = 1e-6;
  tiny.options.gradient_tolerance = kOnlyZero;
  tiny.options.cost_threshold = 0.0;
  tiny.options.parameter_tolerance = options.parameter_tolerance;
  accepted = iterations = 0;
  is_slow = false;
  initial_cost = -1.0;
  point = Eigen::Map<const Eigen::VectorXd>(u.data(), static_cast<Eigen::Index>(u.size()));
  double last_cost = std::numeric_limits<double>::infinity();
  do {
    is_first = true;
    is_last = goes_on = false;
    tiny.options.max_num_iterations = options.max_iterations - iterations;
    tiny.Solve(Function{this}, &point);
    iterations += std::max(tiny.summary.iterations, 1);
    if (initial_cost < 0) initial_cost = tiny.summary.initial_cost;
    // A step that ends the search is not accepted by a call.
    if (!std::equal(raw.begin(), raw.end(), point.data())) {
      at = trial;
      cost = trial_cost;
    }
    const bool was_damped = tiny.summary.status == TinySolver::COST_CHANGE_TOO_SMALL &&
                            cost < last_cost && compressed.Explained() > kGainWorthGoingOn * cost;
    goes_on = goes_on || was_damped;
    last_cost = cost;
  } while (goes_on && iterations < options.max_iterations);
  std::ranges::copy(at, u.begin());
}

const char* Solver::Search::Message() const {
  if (!std::isfinite(cost)) return "The residuals at the start are not finite.";
  if (is_slow) return "Twenty steps together raised twice the log-likelihood by less than 1e-3.";
  switch (tiny.summary.status) {
    case TinySolver::GRADIENT_TOO_SMALL:
      return "No step can lower the cost by more than the function tolerance.";
    case TinySolver::RELATIVE_STEP_SIZE_TOO_SMALL:
      return "No parameter moves by more than the parameter tolerance.";
    case TinySolver::COST_TOO_SMALL:
      return "The cost is zero.";
    case TinySolver::COST_CHANGE_TOO_SMALL:
      return "The last step changed the cost by less than the function tolerance.";
    case TinySolver::HIT_MAX_ITERATIONS:
      break;
  }
  return "The solver made its maximum number of iterations.";
}

Solver::Solver() : search_(std::make_unique<Search>()) {}
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;
Solver::~Solver() = default;

namespace {

/// True if a coordinate that lies at one of its bounds would lower the cost on its way back.
/// @param others  room for a mark of each coordinate
bool LeadsInward(const ProjectedResidual& residual, std::span<const double> u, double tolerance,
                 std::vector<unsigned char>& others) {
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
  return CompressedResidual(residual.normal(), residual.gradient(), 0.0, others).Explained() >
         tolerance;
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
  search.max_num_iterations = max_iterations;
  ceres::Solver::Summary summary;
  ceres::Solve(search, &problem, &summary);
  return summary;
}

}  // namespace

void Solver::SearchFrom(std::span<double> u, const SolverOptions& options, Solution& solution) {
  Search& search = *search_;
  const double floor =
      static_cast<double>(residual_.problem().data->counted) * kRoundingRms * kRoundingRms;
  SolverReport& report = solution.report;
  report.solver = "tiny_solver";
  search.Start(residual_, options, floor);
  double last_cost = std::numeric_limits<double>::infinity();
  // Each pass lets go what lies at a bound and leads inward.
  for (std::size_t pass = 0; pass <= u.size(); ++pass) {
    search.Run(u);
    report.iterations += search.iterations;
    if (pass == 0) report.initial_cost = search.initial_cost;
    const bool is_lower = search.cost < last_cost;
    last_cost = search.cost;
    if (!is_lower || !IsAtBound(residual_, u)) break;
    search.trial.assign(u.begin(), u.end());
    search.trial_cost = residual_.Linearise(u);
    search.trial_is_linearised = true;
    search.trial_is_predicted = false;
    if (!LeadsInward(residual_, u, options.function_tolerance * search.cost, search.clamped)) break;
  }
  double cost = search.cost;
  const bool hit_maximum = search.tiny.summary.status == Search::TinySolver::HIT_MAX_ITERATIONS;
  solution.converged = !hit_maximum && std::isfinite(cost);
  report.termination = solution.converged ? "CONVERGENCE" : "NO_CONVERGENCE";
  report.message = search.Message();
  bool is_evaluated = std::equal(u.begin(), u.end(), search.trial.begin());
  const bool is_predicted = is_evaluated && search.trial_is_predicted;
  const int left = options.max_iterations - report.iterations;
  if (!options.is_rough && left > 0 && (!solution.converged || IsAtBound(residual_, u)) &&
      std::isfinite(cost)) {
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
  if (!is_predicted) {
    solution.residual.assign(residual_.residual().begin(), residual_.residual().end());
  }
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

double Solver::CostAt(std::span<double> theta) {
  u_.resize(residual_.searched().size());
  residual_.Load(theta, u_);
  const double cost = residual_.Evaluate(u_);
  residual_.Store(u_, theta);
  return cost;
}

void Solver::Solve(std::span<const double> start, const SolverOptions& options,
                   Solution& solution) {
  const Parameters& parameters = residual_.problem().parameters;
  solution.theta.assign(residual_.theta().begin(), residual_.theta().end());
  solution.residual.clear();
  solution.report.iterations = 0;
  residual_.ReleaseLinear();
  u_.resize(residual_.searched().size());
  residual_.Load(start, u_);
  // Each pass holds one more linear parameter at the bound that it had passed.
  for (std::size_t pass = 0; pass <= parameters.size(); ++pass) {
    if (u_.empty()) {
      solution.sum_of_squares = residual_.Evaluate(u_);
      solution.residual.assign(residual_.residual().begin(), residual_.residual().end());
      solution.converged = std::isfinite(solution.sum_of_squares);
      solution.report.solver = "none";
      solution.report.termination = "CONVERGENCE";
      solution.report.message = parameters.free().empty()
                                    ? "every parameter is fixed"
                                    : "Every parameter that is not linear is fixed.";
      solution.report.initial_cost = solution.sum_of_squares / 2;
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
