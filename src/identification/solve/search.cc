#include "identification/solve/search.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "identification/solve/unprojected_residual.h"

namespace mindahl::identification {

SolverOptions SolverOptionsOf(const FitOptions& options) {
  // A full step from there is the last: it leaves far less than it gains.
  constexpr double kLastStep = 100.0;  // function tolerances
  return {.function_tolerance = options.function_tolerance,
          .max_iterations = options.max_iterations,
          .last_step = kLastStep * options.function_tolerance};
}

double FindStartsOf(Candidate& candidate, ThinnedRecords& thinned, const FitOptions& options,
                    double rival, Solver& solver) {
  if (auto given = GivenStart(candidate.problem.parameters, options)) {
    candidate.starts = {std::move(*given)};
    return 0.0;
  }
  const ScaledRecords& thin = thinned.Get();
  // If a window or a fold leaves little of the thinned record, the whole record is used.
  constexpr std::size_t kEnough = 4;  // samples a parameter
  const bool is_enough = thin.counted >= kEnough * candidate.problem.parameters.free().size();
  // A thinned record has the history of the whole, and so determines a law; a column that wanders
  // as it likes explains a few samples a stroke whatever the law is.
  const bool has_covariate = std::ranges::any_of(
      candidate.problem.parameters.free(),
      [&](std::size_t p) { return candidate.problem.parameters[p].term->of_column; });
  const bool has_kinks = HasKinks(candidate.problem.parameters);
  const ScaledRecords& looked_at =
      is_enough && !has_covariate && !has_kinks ? thin : *candidate.problem.data;
  const Problem problem{&looked_at, candidate.problem.model, candidate.problem.states,
                        candidate.problem.parameters};
  candidate.starts = FindStarts(problem, options, rival, solver);
  return candidate.starts.empty() ? std::numeric_limits<double>::infinity()
                                  : candidate.starts.front().cost;
}

void AddStartsOfSmallerModels(Candidate& candidate, ThinnedRecords& thinned,
                              const FitOptions& options, Solver& solver) {
  constexpr std::size_t kMostNested = 3;
  if (!options.start.empty()) return;
  const Parameters& parameters = candidate.problem.parameters;
  std::vector<std::size_t> terms;
  for (const std::size_t p : parameters.free()) {
    // Only terms that lead a group; its further coefficients stay with them.
    const Term& term = *parameters[p].term;
    const bool is_on_demand = term.presence == Presence::kOnDemand && !term.group.empty();
    if (is_on_demand && !parameters[p].has_prior()) terms.push_back(p);
  }
  for (const std::size_t p : terms) {
    const double neutral = p == kRig ? parameters[p].upper : parameters[p].ToTheta(0.0);
    if (neutral < parameters[p].lower || neutral > parameters[p].upper) continue;
    Candidate smaller = candidate;
    smaller.problem.parameters.Fix(p, neutral);
    FindStartsOf(smaller, thinned, options, std::numeric_limits<double>::infinity(), solver);
    if (terms.size() <= kMostNested) {
      AddStartsOfSmallerModels(smaller, thinned, options, solver);
    }
    Descend(smaller, options, solver);
    const Solution& solution = smaller.solution;
    if (!std::isfinite(solution.sum_of_squares)) continue;
    candidate.starts.push_back({.theta = solution.theta, .cost = solution.sum_of_squares});
  }
}

namespace {

/// True if slip begins so sharply that the sum of squares has a minimum between any two samples.
bool IsAmongKinks(const Parameters& parameters, const Solution& solution) {
  constexpr double kSharp = 0.1;
  return !parameters[kShape].fixed && solution.theta[kShape] < kSharp;
}

/// Searches of one problem, of which the lowest end is kept.
struct Rivals {
  void From(std::span<const double> theta) {
    Solution scratch;
    solver.Solve(theta, SolverOptionsOf(options), scratch);
    if (scratch.sum_of_squares < best.sum_of_squares) std::swap(best, scratch);
  }

  const FitOptions& options;
  Solver& solver;
  Solution& best;
};

/// Searches from next to a minimum: with slip that begins sooner or later, and with a smoother law.
void SearchAcrossKinks(const Problem& problem, Rivals& rivals) {
  constexpr double kSmoother = 0.1;
  const std::vector<double> from = rivals.best.theta;
  std::vector<double> theta = from;
  theta[kShape] += kSmoother;
  rivals.From(theta);
  for (const double log_stiffness : {-0.2, -0.1, -0.03, 0.03, 0.1, 0.2}) {
    theta = from;
    theta[kStiffness] += log_stiffness;
    rivals.From(theta);
  }
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const std::size_t origin = problem.parameters.PositionOfOrigin(r);
    if (problem.parameters[origin].fixed) continue;
    for (const double step : {-0.05, 0.05}) {
      theta = rivals.best.theta;
      theta[origin] += step;
      rivals.From(theta);
    }
  }
}

/// Searches with other parts of the compliance in the rig: a sharp knee behind a soft rig resembles
/// a round one.
void SearchOtherRigs(Rivals& rivals) {
  const std::vector<double> from = rivals.best.theta;
  const double compliance = std::exp(-from[kStiffness]) + std::exp(-from[kRig]);
  for (const double share : {0.2, 0.5, 0.8}) {
    for (const double shape : {0.02, 1.0 / 3}) {
      std::vector<double> theta = from;
      theta[kStiffness] = -std::log((1 - share) * compliance);
      theta[kRig] = -std::log(share * compliance);
      theta[kShape] = shape;
      // A law that bends from the start has a slip force far beyond the largest force, of about 1.
      theta[kSlipForce] = std::min(theta[kSlipForce], 0.0);
      rivals.From(theta);
    }
  }
}

/// Searches once more with virgin contacts unloaded at their first samples, where the search has
/// led away from these: a thinned record of much noise may have.
void SearchFromFirstSamples(const Problem& problem, Rivals& rivals) {
  constexpr double kAway = 0.1;
  std::vector<double> theta = rivals.best.theta;
  bool has_moved = false;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const std::size_t origin = problem.parameters.PositionOfOrigin(r);
    if (problem.parameters[origin].fixed) continue;
    const double first = problem.data->records[r].excitation().front();
    has_moved = has_moved || std::abs(theta[origin] - first) > kAway;
    theta[origin] = first;
  }
  if (has_moved) rivals.From(theta);
}

}  // namespace

void Descend(Candidate& candidate, const FitOptions& options, Solver& solver) {
  Solution& best = candidate.solution;
  best = {.sum_of_squares = std::numeric_limits<double>::infinity()};
  best.report.message = "no loop is seen: the force does not follow the displacement";
  if (candidate.starts.empty()) return;
  solver.Bind(candidate.problem);
  Rivals rivals{options, solver, best};
  for (const StartingPoint& start : candidate.starts) rivals.From(start.theta);
}

void SearchBesideMinimum(Candidate& candidate, const FitOptions& options, Solver& solver) {
  Solution& best = candidate.solution;
  if (!options.start.empty() || !std::isfinite(best.sum_of_squares)) return;
  Rivals rivals{options, solver, best};
  const Parameters& parameters = candidate.problem.parameters;
  const Parameter& rig = parameters[kRig];
  if (!rig.absent && !rig.fixed && !rig.has_prior()) SearchOtherRigs(rivals);
  SearchFromFirstSamples(candidate.problem, rivals);
  if (IsAmongKinks(parameters, best)) SearchAcrossKinks(candidate.problem, rivals);
}

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

void SolveRobustly(const Problem& problem, Loss loss, double scale, const SolverOptions& options,
                   Solution& solution) {
  std::vector<double>& theta = solution.theta;
  const std::unique_ptr<ceres::LossFunction> loss_function = LossOf(loss);
  ceres::Problem::Options of_problem;
  of_problem.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(of_problem);
  const auto residual = std::make_shared<UnprojectedResidual>(problem, scale);
  std::vector<double*> blocks;
  for (const std::size_t p : residual->blocks()) blocks.push_back(&theta[p]);
  AddResidual(residual, blocks, loss_function.get(), ceres_problem);
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
  ceres::Solver::Summary summary;
  ceres::Solve(CeresOptionsOf(options, ceres::DENSE_NORMAL_CHOLESKY), &ceres_problem, &summary);
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  solution.report.solver = "solve";
  solution.report.termination = ceres::TerminationTypeToString(summary.termination_type);
  solution.report.message = summary.message;
  solution.report.iterations += static_cast<int>(summary.iterations.size());
  solution.side.assign(theta.size(), BoundSide::kInside);
  for (const std::size_t p : problem.parameters.free()) {
    solution.side[p] = SideOf(problem.parameters[p], theta[p]);
  }
}

}  // namespace mindahl::identification
