#include "identification/solved_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/refuse.h"
#include "identification/inference/reweighting.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// Refuses fewer samples that count than free parameters, and says what was left out.
void RequireEnoughSamples(const Problem& problem, const loop::PreparedRecords& prepared) {
  const std::size_t free = problem.parameters.free().size();
  const std::size_t counted = problem.data->counted;
  if (counted > free) return;
  const std::size_t left_out = prepared.samples() - counted;
  const std::string without = left_out == 0 ? ""
                                            : fmt::format("; of {} that were read {} are left out",
                                                          prepared.samples(), left_out);
  Refuse<InvalidArgument>(
      "{} samples are too few for {} free parameters{}: record more or fix some", counted, free,
      without);
}

/// Returns the initial state that the options name, else both where both are possible.
std::vector<models::InitialState> StatesToTry(const Attempt& attempt) {
  if (attempt.options.initial_state) return {*attempt.options.initial_state};
  const bool unloaded_is_given = std::ranges::any_of(attempt.options.fixed, [&](const auto& fixed) {
    return fixed.first.starts_with(TermOf(OriginId(attempt.data.excitation)).name);
  });
  std::vector<models::InitialState> states = {models::InitialState::kVirgin};
  if (!unloaded_is_given && std::ranges::any_of(attempt.data.records, &ScaledRecord::Turns)) {
    states.push_back(models::InitialState::kSteady);
  }
  return states;
}

/// True if the search of where a contact was unloaded stopped at its limit: it had been cycled.
bool IsUnloadedAtLimit(const Candidate& candidate) {
  if (!std::isfinite(candidate.solution.sum_of_squares)) return false;  // none was made
  const auto& [problem, starts, solution] = candidate;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const std::size_t p = problem.parameters.PositionOfOrigin(r);
    const Parameter& origin = problem.parameters[p];
    if (IsSearchLimit(origin, SideOf(origin, solution.theta[p]))) return true;
  }
  return false;
}

/// True if the energy of all loops is clearly negative: the sign of the force is wrong.
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
  for (const models::InitialState state : StatesToTry(attempt)) {
    candidates.push_back({.problem = {attempt.data, options, state}});
    RequireEnoughSamples(candidates.back().problem, attempt.prepared);
  }
  if (GiveEnergy(options, attempt.prepared)) {
    Descend(candidates.front(), options);  // without a start
    return {.best = std::move(candidates.front())};
  }
  std::vector<double> costs;  // at the best starts
  for (Candidate& candidate : candidates) costs.push_back(FindStartsOf(candidate, thin, options));
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
  const Evidence evidence = EvidenceOf(better.problem, better.solution.theta);
  const auto criterion = [&](const Candidate& candidate) {
    return evidence.Aicc(candidate.solution.sum_of_squares,
                         candidate.problem.parameters.free().size());
  };
  const double gain = criterion(steady) - criterion(virgin);
  // Unloaded at the search's own limit, the virgin state must be better by ΔAICc = 10.
  const bool is_doubtful = steady.solution.converged && IsUnloadedAtLimit(virgin);
  const bool is_virgin = gain > (is_doubtful ? options.thresholds.undecided : 0.0);
  const Candidate& other = is_virgin ? steady : virgin;
  SolvedFit solved{.best = std::move(is_virgin ? virgin : steady)};
  if (std::abs(gain) < options.thresholds.indistinguishable && other.solution.converged) {
    solved.of_other_state = other.problem.parameters.LawAt(other.solution.theta);
  }
  return solved;
}

/// Fits once more with turns between samples, where these may matter, and keeps that unless it fits
/// clearly worse: a rig turns between samples, a simulation may turn at them. A contact that slips
/// on the way from a sample to the turn has no stiffness that samples show.
void TryTurnsBetweenSamples(const Attempt& attempt, Candidate& candidate) {
  // [standard errors of the force] With a bias of this size a 95 % interval covers 94.5 %.
  constexpr double kMatters = 0.2;
  constexpr double kClearly = 4.0;  // of twice the log-likelihood
  Solution& solution = candidate.solution;
  const auto samples = static_cast<double>(attempt.data.counted);
  const double farthest = TurnBetweenSamples(attempt.data);
  const double shift = farthest * std::exp(solution.theta[kStiffness]);
  if (shift > kMatters * (std::sqrt(solution.sum_of_squares) / samples)) {
    ProjectedResidual residual(candidate.problem);
    Solution between =
        Solve(residual, solution.theta, {.max_iterations = attempt.options.max_iterations});
    const double ratio = between.sum_of_squares / solution.sum_of_squares;
    const double rate = std::exp(between.theta[kStiffness] - between.theta[kSlipForce]);
    if (farthest * rate < 1 && samples * std::log(ratio) < kClearly) {
      solution = std::move(between);
      return;
    }
  }
  for (ScaledRecord& record : attempt.data.records) record.turns_between = false;
}

}  // namespace

ScaledRecords ScaledAsFitted(std::span<const loop::RecordView> records, FitOptions options,
                             const FitOptions& with, const FitResult& fit) {
  options.preparation.force_sense = fit.force_sense;
  loop::PreparedRecords prepared = loop::Prepare(records, options.preparation);
  ScaledRecords data = Scale(prepared, options, &with);
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    data.records[r].turns_between = fit.records[r].turns_between;
  }
  return data;
}

SolvedFit SolveFit(const Attempt& attempt) {
  const FitOptions& options = attempt.options;
  SolvedFit solved = FitBestState(attempt);
  Candidate& best = solved.best;
  if (best.problem.parameters[kAsymmetry].confounded) {
    throw InvalidArgument(
        "asymmetry cannot be distinguished from force_offset: the contact had slipped before the "
        "fitted samples, so both are a constant force; give the force's zero if it is known, --fix "
        "force_offset=0, or fit a record that includes the first loading of the unloaded contact, "
        "with --initial-state virgin");
  }
  if (!std::isfinite(best.solution.sum_of_squares)) return solved;
  TryTurnsBetweenSamples(attempt, best);
  const auto fit_with_weights = [&] {
    solved.is_settled =
        FitWithWeights(best.problem, attempt.data, options, best.solution, solved.noise);
  };
  fit_with_weights();
  if (options.loss == Loss::kNone) return solved;
  // Outliers may have hidden the initial state: once more from all starts, as weighted.
  SolvedFit again = FitBestState(attempt);
  if (!std::isfinite(again.solution().sum_of_squares)) return solved;
  solved = std::move(again);
  fit_with_weights();
  return solved;
}

}  // namespace mindahl::identification
