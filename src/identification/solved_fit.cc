#include "identification/solved_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identification/inference/noise.h"
#include "identification/inference/reweighting.h"
#include "identification/problem/motion.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

using models::InitialState;

/// Refuses fewer samples that count than free parameters, and says what was left out.
void RequireEnoughSamples(const Problem& problem, const loop::PreparedRecords& prepared) {
  const std::size_t free = problem.parameters.free().size();
  const std::size_t counted = problem.data->counted;
  if (counted > free) return;
  const std::size_t left_out = prepared.samples() - counted;
  const std::string without = left_out == 0 ? ""
                                            : fmt::format("; of {} that were read {} are left out",
                                                          prepared.samples(), left_out);
  throw InvalidArgument(
      fmt::format("{} samples are too few for {} free parameters{}: record more or fix some",
                  counted, free, without));
}

/// Refuses to fit an asymmetry after slip, where it is confounded with the force's offset.
void RequireToldAsymmetry(const Problem& problem) {
  if (!problem.parameters[kAsymmetry].confounded) return;
  throw InvalidArgument(
      "asymmetry cannot be distinguished from force_offset: the contact had slipped before the "
      "fitted samples, so both are a constant force; give the force's zero if it is known, --fix "
      "force_offset=0, or fit a record that includes the first loading of the unloaded contact, "
      "with --initial-state virgin");
}

/// Returns the initial state that the options name, else both where both are possible.
std::vector<InitialState> StatesToTry(const Attempt& attempt) {
  if (attempt.options.initial_state) return {*attempt.options.initial_state};
  const bool unloaded_is_given = std::ranges::any_of(attempt.options.fixed, [&](const auto& fixed) {
    return fixed.first.starts_with(TermOf(OriginId(attempt.data.excitation)).name);
  });
  std::vector<InitialState> states = {InitialState::kVirgin};
  if (!unloaded_is_given && std::ranges::any_of(attempt.data.records, &ScaledRecord::Turns)) {
    states.push_back(InitialState::kSteady);
  }
  return states;
}

/// True if the search of where a contact was unloaded stopped at a limit of its own: it was rather
/// cycled before the record.
bool IsUnloadedAtLimit(const Candidate& candidate) {
  if (!std::isfinite(candidate.solution.sum_of_squares)) return false;  // none was made
  const Parameters& parameters = candidate.problem.parameters;
  for (std::size_t r = 0; r < candidate.problem.data->records.size(); ++r) {
    const std::size_t p = parameters.PositionOfOrigin(r);
    const BoundSide side = SideOf(parameters[p], candidate.solution.theta[p]);
    if (IsSearchLimit(parameters[p], side)) return true;
  }
  return false;
}

/// True if the energy of all loops is clearly negative: a contact dissipates, so that the sign of
/// the force is wrong.
bool GiveEnergy(const FitOptions& options, const loop::PreparedRecords& prepared) {
  constexpr double kClear = 0.2;  // [W/(4XT*)]: noise alone gives a tenth
  if (!options.terms.empty() || !options.covariates.empty() || !options.fixed.empty()) return false;
  return std::ranges::all_of(prepared.records, [](const loop::PreparedRecord& record) {
    return record.facts.closed && record.facts.energy_ratio < -kClear;
  });
}

SolvedFit FitBestState(const Attempt& attempt) {
  const FitOptions& options = attempt.options;
  // A fit that is given a start looks for others on all samples, where it does.
  std::optional<ScaledRecords> thinned;
  if (options.start.empty()) thinned = Thinned(attempt.data);
  const ScaledRecords& thin = thinned ? *thinned : attempt.data;
  const auto descend = [&](Candidate& candidate) {
    AddStartsOfSmallerModels(candidate, thin, options);
    Descend(candidate, options);
    SearchBesideMinimum(candidate, options);
  };
  std::vector<Candidate> candidates;
  for (const InitialState state : StatesToTry(attempt)) {
    candidates.emplace_back(attempt.data, options, state);
    RequireEnoughSamples(candidates.back().problem, attempt.prepared);
  }
  if (GiveEnergy(options, attempt.prepared)) {
    Descend(candidates.front(), options);  // without a start
    return {.best = std::move(candidates.front())};
  }
  std::vector<double> costs;  // at the best starts
  for (Candidate& candidate : candidates) {
    costs.push_back(FindStartsOf(candidate, thin, options));
  }
  Candidate& virgin = candidates.front();
  Candidate& steady = candidates.back();
  // A start from the options has no cost.
  for (std::size_t k = 0; candidates.size() > 1 && options.start.empty() && k < 2; ++k) {
    if (!(costs[1 - k] > options.thresholds.hopeless * costs[k])) continue;
    descend(candidates[k]);
    if (candidates[k].solution.converged) return {.best = std::move(candidates[k])};
  }
  std::ranges::for_each(candidates, descend);
  const Candidate& better =
      virgin.solution.sum_of_squares < steady.solution.sum_of_squares ? virgin : steady;
  // Neither may even have been started.
  if (candidates.size() == 1 || !std::isfinite(better.solution.sum_of_squares)) {
    return {.best = std::move(virgin)};
  }
  const Evidence evidence(attempt.data.counted,
                          EffectiveSamples(better.problem, better.solution.theta));
  const auto criterion = [&](const Candidate& candidate) {
    return evidence.Aicc(candidate.solution.sum_of_squares,
                         candidate.problem.parameters.free().size());
  };
  const double gain = criterion(steady) - criterion(virgin);
  // If the search moved the unloaded position to its own limit, the virgin state is chosen only if
  // it fits better by ΔAICc = 10.
  const bool is_doubtful = steady.solution.converged && IsUnloadedAtLimit(virgin);
  const bool is_virgin = gain > (is_doubtful ? options.thresholds.undecided : 0.0);
  Candidate& best = is_virgin ? virgin : steady;
  const Candidate& other = is_virgin ? steady : virgin;
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
    Solution between =
        Solver(candidate.problem).Solve(solution.theta, SolverOptionsOf(attempt.options));
    const double ratio = between.sum_of_squares / solution.sum_of_squares;
    const double rate = std::exp(between.theta[kStiffness] - between.theta[kSlipForce]);
    if (farthest * rate < 1 &&
        static_cast<double>(attempt.data.counted) * std::log(ratio) < kClearly) {
      solution = std::move(between);
      return;
    }
  }
  for (ScaledRecord& record : attempt.data.records) record.turns_between = false;
}

}  // namespace

SolvedFit SolveFit(const Attempt& attempt) {
  const FitOptions& options = attempt.options;
  SolvedFit solved = FitBestState(attempt);
  Candidate& best = solved.best;
  RequireToldAsymmetry(best.problem);
  if (!std::isfinite(best.solution.sum_of_squares)) return solved;
  TryTurnsBetweenSamples(attempt, best);
  const auto fit_with_weights = [&] {
    solved.is_settled = FitWithWeights(best.problem, attempt.data, options, attempt.drawn,
                                       best.solution, solved.noise);
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
