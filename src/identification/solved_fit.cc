#include "identification/solved_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "identification/inference/local.h"
#include "identification/inference/noise.h"
#include "identification/inference/reweighting.h"
#include "identification/problem/requirements.h"
#include "identification/problem/turning_points.h"

namespace mindahl::identification {
namespace {

using models::InitialState;

/// Returns a state for all records.
std::vector<InitialState> ForAll(const Attempt& attempt, InitialState state) {
  return std::vector(attempt.data.records.size(), state);
}

/// Returns the initial states that the options name; nothing where both have to be tried.
std::vector<InitialState> GivenStates(const Attempt& attempt) {
  const std::vector<InitialState>& given = attempt.options.initial_states;
  if (!given.empty()) return given.size() == 1 ? ForAll(attempt, given.front()) : given;
  const bool unloaded_is_given = std::ranges::any_of(attempt.options.fixed, [&](const auto& fixed) {
    return fixed.first.starts_with(TermOf(OriginId(attempt.data.excitation)).name);
  });
  if (unloaded_is_given || std::ranges::none_of(attempt.data.records, &ScaledRecord::Turns)) {
    return ForAll(attempt, InitialState::kVirgin);
  }
  return {};
}

/// Fits from the initial state that the options name, or that Akaike's criterion prefers.
SolvedFit FitBestState(const Attempt& attempt) {
  const FitOptions& options = attempt.options;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  ThinnedRecords thin(attempt.data);
  const auto make = [&](const std::vector<InitialState>& states) {
    Candidate candidate(attempt.data, options, states);
    RequireEnoughSamples(candidate.problem, attempt.prepared);
    return candidate;
  };
  const auto descend = [&](Candidate& candidate) {
    AddStartsOfSmallerModels(candidate, thin, options, attempt.solver);
    Descend(candidate, options, attempt.solver);
    SearchBesideMinimum(candidate, options, attempt.solver);
  };
  const std::vector<InitialState> given = GivenStates(attempt);
  if (!given.empty()) {
    Candidate candidate = make(given);
    FindStartsOf(candidate, thin, options, kNone, attempt.solver);
    descend(candidate);
    return {.best = std::move(candidate)};
  }
  Candidate virgin = make(ForAll(attempt, InitialState::kVirgin));
  Candidate steady = make(ForAll(attempt, InitialState::kSteady));
  const double virgin_cost = FindStartsOf(virgin, thin, options, kNone, attempt.solver);
  const double virgin_look = virgin.starts.empty() ? kNone : virgin.starts.front().look;
  const double steady_cost = FindStartsOf(steady, thin, options, virgin_look, attempt.solver);
  // A start from the options has no cost.
  const bool is_looked_at = options.start.empty();
  for (auto& [candidate, cost, other] : {std::tuple(&virgin, virgin_cost, steady_cost),
                                         std::tuple(&steady, steady_cost, virgin_cost)}) {
    if (!is_looked_at || !(other > options.thresholds.hopeless * cost)) continue;
    descend(*candidate);
    if (candidate->solution.converged) return {.best = std::move(*candidate)};
  }
  descend(virgin);
  descend(steady);
  const Candidate& better =
      virgin.solution.sum_of_squares < steady.solution.sum_of_squares ? virgin : steady;
  // Neither may even have been started.
  if (!std::isfinite(better.solution.sum_of_squares)) return {.best = std::move(virgin)};
  const Evidence evidence(
      attempt.data.counted,
      EffectiveSamples(better.problem, better.solution.theta, attempt.solver.response));
  const auto criterion = [&](const Candidate& candidate) {
    return evidence.Aicc(candidate.solution.sum_of_squares,
                         candidate.problem.parameters.free().size());
  };
  const double gain = criterion(steady) - criterion(virgin);
  Candidate& best = gain > 0 ? virgin : steady;
  const Candidate& other = gain > 0 ? steady : virgin;
  std::optional<models::BranchLaw> law;
  if (std::abs(gain) < options.thresholds.indistinguishable && other.solution.converged) {
    law = other.problem.parameters.LawAt(other.solution.theta);
  }
  return {.best = std::move(best), .of_other_state = law};
}

/// Fits once more with turns between samples, where these may matter, and keeps that unless it fits
/// clearly worse: a rig turns between samples, a simulation may turn at them. A contact that slips
/// on the way from a sample to the turn has no stiffness that samples show.
void TryTurnsBetweenSamples(const Attempt& attempt, Candidate& candidate) {
  // [standard errors of the force] With a bias of this size a 95 % interval covers 94.5 %.
  constexpr double kMatters = 0.2;
  constexpr double kClearly = 4.0;  // of twice the log-likelihood
  Solution& solution = candidate.solution;
  const double farthest = TurnBetweenSamples(attempt.data);
  const double shift = farthest * std::exp(solution.theta[kStiffness]);
  const double error =
      std::sqrt(solution.sum_of_squares) / static_cast<double>(attempt.data.counted);
  if (shift > kMatters * error) {
    Solution between;
    attempt.solver.Bind(candidate.problem);
    attempt.solver.Solve(solution.theta, SolverOptionsOf(attempt.options), between);
    const double ratio = between.sum_of_squares / solution.sum_of_squares;
    const double rate = std::exp(between.theta[kStiffness] - between.theta[kSlipForce]);
    if (farthest * rate < 1 &&
        static_cast<double>(attempt.data.counted) * std::log(ratio) < kClearly) {
      solution = std::move(between);
      return;
    }
  }
  TurnAtSamples(attempt.data);
}

}  // namespace

SolvedFit SolveFit(const Attempt& attempt) {
  const FitOptions& options = attempt.options;
  SolvedFit solved = FitBestState(attempt);
  Candidate& best = solved.best;
  RequireToldAsymmetry(best.problem);
  if (!std::isfinite(best.solution.sum_of_squares)) return solved;
  TryTurnsBetweenSamples(attempt, best);
  if (options.loss == Loss::kNone && attempt.drawn == nullptr) {
    solved.noise = PlainNoise(attempt.data, options, best.solution.sum_of_squares,
                              best.problem.parameters.free().size());
    return solved;
  }
  const auto fit_with_weights = [&] {
    solved.is_settled = FitWithWeights(best.problem, attempt.data, options, attempt.drawn,
                                       attempt.solver, best.solution, solved.noise);
  };
  fit_with_weights();
  if (options.loss == Loss::kNone) return solved;
  // Outliers may have hidden the initial state: once more from all starts, as weighted.
  SolvedFit again = FitBestState(attempt);
  if (!std::isfinite(again.solution().sum_of_squares)) return solved;
  best = std::move(again.best);
  solved.of_other_state = again.of_other_state;
  fit_with_weights();
  return solved;
}

}  // namespace mindahl::identification
