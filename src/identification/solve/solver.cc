#include "identification/solve/solver.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/solve/ceres_options.h"
#include "identification/solve/projected_residual.h"

namespace mindahl::identification {
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
    const CompressedResidual<Eigen::Dynamic> compressed(residual_.normal(), residual_.gradient(),
                                                        cost, {});
    rows = compressed.residual();
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor> jacobian(jacobians[0], rows.size(), static_cast<Eigen::Index>(count));
    jacobian = compressed.jacobian();
    return rows.allFinite() && jacobian.allFinite();  // Ceres would print what is not
  }

 private:
  ProjectedResidual& residual_;
};

}  // namespace

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
  const CompressedResidual<Eigen::Dynamic> compressed(residual.normal(), residual.gradient(), 0.0,
                                                      others);
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
  search.max_num_iterations = max_iterations;
  ceres::Solver::Summary summary;
  ceres::Solve(search, &problem, &summary);
  return summary;
}

}  // namespace

void Solver::SearchFrom(std::span<double> u, const SolverOptions& options, Solution& solution) {
  std::unique_ptr<TinySearch>& own = searches_[std::min(u.size(), searches_.size()) - 1];
  if (own == nullptr) own = TinySearch::Make(u.size());
  TinySearch& search = *own;
  const double floor =
      static_cast<double>(residual_.problem().data->counted) * kRoundingRms * kRoundingRms;
  SolverReport& report = solution.report;
  report.solver = "tiny_solver";
  // A third of the steps is left to the second opinion.
  SolverOptions of_tiny = options;
  if (!options.is_rough) of_tiny.max_iterations -= options.max_iterations / 3;
  search.Start(residual_, of_tiny, floor);
  double last_cost = std::numeric_limits<double>::infinity();
  // Each pass lets go what lies at a bound and leads inward.
  for (std::size_t pass = 0; pass <= u.size(); ++pass) {
    search.Run(u);
    report.iterations += search.iterations();
    if (pass == 0) report.initial_cost = search.initial_cost();
    const bool is_lower = search.cost() < last_cost;
    last_cost = search.cost();
    if (!is_lower || !IsAtBound(residual_, u)) break;
    search.KnowsLinearised(u, residual_.Linearise(u));
    if (!LeadsInward(residual_, u, options.function_tolerance * search.cost(), search.marks())) {
      break;
    }
  }
  double cost = search.cost();
  solution.converged = !search.hit_maximum() && std::isfinite(cost);
  report.termination = solution.converged ? "CONVERGENCE" : "NO_CONVERGENCE";
  report.message = search.Message();
  bool is_evaluated = search.IsEvaluatedAt(u);
  const bool is_predicted = is_evaluated && search.is_predicted();
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
