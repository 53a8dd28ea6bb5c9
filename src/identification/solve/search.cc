#include "identification/solve/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace mindahl::identification {

SolverOptions SolverOptionsOf(const FitOptions& options) {
  return {.max_iterations = options.max_iterations};
}

void AddStartsOfSmallerModels(Candidate& candidate, const ScaledRecords& thinned,
                              const FitOptions& options, Solver& solver) {
  constexpr std::size_t kMostNested = 3;
  if (!options.start.empty()) return;
  const Parameters& parameters = candidate.problem.parameters;
  std::vector<std::size_t> terms;
  for (const std::size_t p : parameters.free()) {
    // Further coefficients of a group stay with the one that leads it, an exponent with its factor.
    const Term& term = *parameters[p].term;
    const bool leads = term.of_column || LeadsGroup(term);
    const bool is_on_demand = term.presence == Presence::kOnDemand && leads;
    if (is_on_demand && !parameters[p].has_prior()) terms.push_back(p);
  }
  for (const std::size_t p : terms) {
    const double neutral = p == kRig ? parameters[p].upper : parameters[p].ToTheta(0.0);
    if (neutral < parameters[p].lower || neutral > parameters[p].upper) continue;
    Candidate smaller = candidate;
    smaller.problem.parameters.Fix(p, neutral);
    FindStartsOf(smaller, thinned, options, solver);
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

/// Searches from θ, and keeps the solution where it is better.
void SearchOnce(std::span<const double> theta, const SolverOptions& options, Solver& solver,
                Solution& best) {
  Solution solution;
  solver.Solve(theta, options, solution);
  if (solution.sum_of_squares < best.sum_of_squares) best = std::move(solution);
}

/// Returns points next to a solution from which there may be a way to a lower minimum.
std::vector<std::vector<double>> Neighbours(const Problem& problem,
                                            const std::vector<double>& solution) {
  constexpr double kSharp = 0.1;       // α
  constexpr double kSharpest = 0.003;  // α
  constexpr double kAway = 0.1;
  constexpr double kUnreached = 0.05;  // of ln Tc above the largest force
  const Parameters& parameters = problem.parameters;
  std::vector<std::vector<double>> neighbours;
  // Other parts of the compliance in the rig: a sharp knee behind a soft rig resembles a round one.
  const Parameter& rig = parameters[kRig];
  const bool rig_is_open = !rig.absent && !rig.fixed && !rig.has_prior();
  const double compliance = std::exp(-solution[kStiffness]) + std::exp(-solution[kRig]);
  for (const double share : {0.2, 0.5, 0.8, 0.99}) {
    for (const double shape : {0.02, 1.0}) {
      if (!rig_is_open || (parameters[kShape].fixed && shape == 1.0)) continue;
      std::vector<double>& theta = neighbours.emplace_back(solution);
      theta[kStiffness] = -std::log((1 - share) * compliance);
      theta[kRig] = -std::log(share * compliance);
      theta[kShape] = shape;
      // A law that bends from the start has a slip force far beyond the largest force, of about 1.
      theta[kSlipForce] = std::min(theta[kSlipForce], 0.0);
    }
  }
  // Virgin contacts unloaded at their first samples, where the search has led away from these: a
  // thinned record of much noise may have.
  std::vector<double> at_first = solution;
  bool has_moved = false;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const std::size_t origin = parameters.PositionOfOrigin(r);
    if (parameters[origin].fixed) continue;
    at_first[origin] = problem.data->records[r].excitation().front();
    has_moved = has_moved || std::abs(solution[origin] - at_first[origin]) > kAway;
  }
  if (has_moved) neighbours.push_back(at_first);
  // Slip that begins just before the ends, of a loop that does not slip.
  const bool may_be_sharp =
      !parameters[kShape].fixed && !parameters[kSlipForce].fixed && !problem.data->is_forced();
  if (may_be_sharp && solution[kSlipForce] > kUnreached) {
    std::vector<double>& sharp = neighbours.emplace_back(std::move(at_first));
    sharp[kShape] = kSharpest;
    sharp[kSlipForce] = 0.0;
  }
  // Slip that begins sooner or later, and a smoother law: where slip begins so sharply the sum of
  // squares has a minimum between any two samples.
  if (parameters[kShape].fixed || !(solution[kShape] < kSharp)) return neighbours;
  const auto step = [&](std::size_t p, double by) { neighbours.emplace_back(solution)[p] += by; };
  step(kShape, kSharp);
  for (const double by : {-0.2, -0.1, -0.03, 0.03, 0.1, 0.2}) step(kStiffness, by);
  return neighbours;
}

}  // namespace

void Descend(Candidate& candidate, const FitOptions& options, Solver& solver) {
  Solution& best = candidate.solution;
  best = {.sum_of_squares = std::numeric_limits<double>::infinity()};
  best.report.message = "no loop is seen: the force does not follow the displacement";
  if (candidate.starts.empty()) return;
  solver.Bind(candidate.problem);
  for (const StartingPoint& start : candidate.starts) {
    SearchOnce(start.theta, SolverOptionsOf(options), solver, best);
  }
}

void SearchBesideMinimum(Candidate& candidate, const FitOptions& options, Solver& solver) {
  Solution& best = candidate.solution;
  if (!options.start.empty() || !std::isfinite(best.sum_of_squares)) return;
  constexpr int kMostRounds = 4;
  constexpr double kLower = 1 - 1e-6;
  constexpr int kSteps = 100;  // in which a way down shows
  const SolverOptions search = SolverOptionsOf(options);
  SolverOptions look = search;
  look.max_iterations = std::min(search.max_iterations, kSteps);
  double last = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds && best.sum_of_squares < last; ++round) {
    last = kLower * best.sum_of_squares;
    Solution lower = best;
    for (const std::vector<double>& theta : Neighbours(candidate.problem, best.theta)) {
      SearchOnce(theta, look, solver, lower);
    }
    if (lower.sum_of_squares < best.sum_of_squares) {
      best = lower;
      SearchOnce(lower.theta, search, solver, best);
    }
  }
}

}  // namespace mindahl::identification
