#include "identification/solved_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "identification/inference/noise.h"
#include "identification/inference/reweighting.h"
#include "identification/problem/requirements.h"

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

/// Returns θ of a solution for a problem that holds other origins; one that it has free starts
/// unloaded.
std::vector<double> ThetaFor(const Problem& problem, const Problem& solved,
                             const Solution& solution) {
  std::vector<double> theta = solution.theta;
  for (std::size_t p = 0; p < theta.size(); ++p) {
    const Parameter& parameter = problem.parameters[p];
    if (parameter.fixed) {
      theta[p] = parameter.theta;
    } else if (solved.parameters[p].fixed) {
      theta[p] = problem.data->records[parameter.record].excitation().front();
    }
  }
  return theta;
}

/// Turns the initial state of one record after the other, as long as one of them is clearly the
/// better for it; `criterion` is Akaike's of a candidate.
/// @returns nothing where all records stay as they are
template <typename Criterion>
std::optional<Candidate> FitMixedStates(const Attempt& attempt, const Candidate& pure,
                                        const Criterion& criterion) {
  std::optional<Candidate> best;
  constexpr int kMostPasses = 3;
  bool any = true;
  for (int pass = 0; pass < kMostPasses && any; ++pass) {
    any = false;
    for (std::size_t r = 0; r < attempt.data.records.size(); ++r) {
      const Candidate& from = best ? *best : pure;
      std::vector<InitialState> states = from.problem.states;
      states[r] =
          states[r] == InitialState::kVirgin ? InitialState::kSteady : InitialState::kVirgin;
      Candidate trial(attempt.data, attempt.options, states);
      const std::vector<double> start = ThetaFor(trial.problem, from.problem, from.solution);
      attempt.solver.Bind(trial.problem);
      attempt.solver.Solve(start, SolverOptionsOf(attempt.options), trial.solution);
      const double gain = criterion(from) - criterion(trial);
      if (!(gain >= attempt.options.thresholds.undecided)) continue;
      best.emplace(std::move(trial));
      any = true;
    }
  }
  return best;
}

/// Fits from the initial state that the options name, or that Akaike's criterion prefers; of
/// several records also some as virgin and some as steady, where all as one does not fit.
SolvedFit FitBestState(const Attempt& attempt) {
  const FitOptions& options = attempt.options;
  ThinnedRecords thin(attempt.data);
  const auto make = [&](const std::vector<InitialState>& states) {
    Candidate candidate(attempt.data, options, states);
    RequireEnoughSamples(candidate.problem, attempt.prepared);
    return candidate;
  };
  const auto find_starts = [&](Candidate& candidate,
                               double look = std::numeric_limits<double>::infinity()) {
    return FindStartsOf(candidate, thin, options, look, attempt.solver);
  };
  const auto descend = [&](Candidate& candidate) {
    AddStartsOfSmallerModels(candidate, thin, options, attempt.solver);
    Descend(candidate, options, attempt.solver);
    SearchBesideMinimum(candidate, options, attempt.solver);
  };
  const std::vector<InitialState> given = GivenStates(attempt);
  if (!given.empty()) {
    Candidate candidate = make(given);
    find_starts(candidate);
    descend(candidate);
    return {.best = std::move(candidate)};
  }
  Candidate virgin = make(ForAll(attempt, InitialState::kVirgin));
  Candidate steady = make(ForAll(attempt, InitialState::kSteady));
  const double virgin_cost = find_starts(virgin);
  const double virgin_look =
      virgin.starts.empty() ? std::numeric_limits<double>::infinity() : virgin.starts.front().look;
  const double steady_cost = find_starts(steady, virgin_look);
  const double clearly_worse = options.thresholds.hopeless;
  // Several records may differ in their initial state, and a start from the options has no cost.
  const bool is_one = attempt.data.records.size() == 1;
  const bool is_looked_at = is_one && options.start.empty();
  if (is_looked_at && steady_cost > clearly_worse * virgin_cost) {
    descend(virgin);
    if (virgin.solution.converged) return {.best = std::move(virgin)};
  } else if (is_looked_at && virgin_cost > clearly_worse * steady_cost) {
    descend(steady);
    if (steady.solution.converged) return {.best = std::move(steady)};
  }
  descend(virgin);
  descend(steady);
  const Candidate& better =
      virgin.solution.sum_of_squares < steady.solution.sum_of_squares ? virgin : steady;
  bool is_virgin = true;
  std::optional<Candidate> mixed;
  std::optional<Rival> of_other;
  if (std::isfinite(better.solution.sum_of_squares)) {  // else neither was even started
    const Evidence evidence(
        attempt.data.counted,
        EffectiveSamples(better.problem, better.solution.theta, attempt.solver.response));
    const auto criterion = [&](const Candidate& candidate) {
      return evidence.Aicc(candidate.solution.sum_of_squares,
                           candidate.problem.parameters.free().size());
    };
    const double gain = criterion(steady) - criterion(virgin);
    is_virgin = gain > 0;
    const Candidate& other = is_virgin ? steady : virgin;
    if (std::abs(gain) < options.thresholds.indistinguishable && other.solution.converged) {
      of_other = RivalAt(other.problem.parameters, other.solution.theta);
    }
    if (!is_one) {
      mixed = FitMixedStates(attempt, is_virgin ? virgin : steady, criterion);
    }
  }
  if (mixed) return {.best = std::move(*mixed)};
  return {.best = std::move(is_virgin ? virgin : steady), .other_state = of_other};
}

/// True if the noise of the records is not one, where it is not known.
bool RecordsDifferInNoise(const Attempt& attempt, const Candidate& candidate) {
  const Problem& problem = candidate.problem;
  const bool is_known = attempt.options.response_noise().has_value();
  if (is_known || problem.data->records.size() < 2 ||
      !std::isfinite(candidate.solution.sum_of_squares)) {
    return false;
  }
  std::vector<double> residual(problem.size());
  EvaluateResidual(problem, candidate.solution.theta, attempt.solver.response, residual);
  return ChanceOfOneNoise(problem, residual) < attempt.options.thresholds.doubt;
}

/// Fits again with turning points where the motion has them, by the samples about each reversal: no
/// parameter is spent on them.
/// @returns empty where they may move no parameter by more than `turning_point_shift` standard
///   errors, the record shows its outermost samples to be better, or it allows none
std::optional<TurningPointFit> TurnedFit(const Attempt& attempt, const Candidate& candidate) {
  const Problem& problem = candidate.problem;
  const Solution& best = candidate.solution;
  const ScaledRecords& data = *problem.data;
  const Thresholds& thresholds = attempt.options.thresholds;
  // A gate means noise in the displacement: its outermost samples are the noisiest, and say
  // nothing of where the motion turned.
  const bool gated = std::ranges::any_of(attempt.prepared.records,
                                         [](const auto& record) { return record.gate.gate > 0; });
  // Turning points are not fitted together with a term that moves the samples off them, nor under a
  // load that varies: the path between the samples is not the displacement's alone. An imposed
  // force is taken as it was sampled.
  if (!best.converged || gated || problem.parameters.moves_contact() || data.load_varies ||
      data.is_forced()) {
    return std::nullopt;
  }
  // Residuals of rounding size have nothing left to explain.
  const double rms = std::sqrt(best.sum_of_squares / static_cast<double>(data.counted));
  if (rms < kRoundingRms) return std::nullopt;
  std::vector<double> overshoot;
  double largest = 0.0;
  for (const ScaledRecord& record : data.records) {
    for (std::size_t k = 0; k < record.reversals.size(); ++k) {
      overshoot.push_back(OvershootOfMotion(record, k));
      largest = std::max(largest, overshoot.back());
    }
  }
  // The largest shift: every sample is taken to lie on the steepest part of its branch.
  const double shift = static_cast<double>(data.counted) * std::exp(best.theta[kStiffness]) *
                       largest / std::sqrt(best.sum_of_squares);
  if (!(shift > thresholds.turning_point_shift)) return std::nullopt;
  TurningPointFit fit{std::make_unique<ScaledRecords>(PutInTurningPoints(data, overshoot)), best};
  Problem turned = problem;
  turned.data = fit.records.get();
  Solver& solver = attempt.solver;
  solver.Bind(turned);
  solver.Solve(best.theta, SolverOptionsOf(attempt.options), fit.solution);
  if (!fit.solution.converged) return std::nullopt;
  if (fit.solution.sum_of_squares <= best.sum_of_squares) return fit;
  // If both are nearly as likely, the fit that does not take a sample for a turn is chosen.
  const Evidence evidence(data.counted, EffectiveSamples(problem, best.theta, solver.response));
  const double loss = evidence.LikelihoodRatio(fit.solution.sum_of_squares, best.sum_of_squares);
  if (loss > thresholds.indistinguishable) return std::nullopt;
  return fit;
}

}  // namespace

SolvedFit SolveFit(const Attempt& attempt) {
  const FitOptions& options = attempt.options;
  Solver& solver = attempt.solver;
  ScaledRecords& data = attempt.data;
  SolvedFit solved = FitBestState(attempt);
  Candidate& best = solved.best;
  RequireToldAsymmetry(best.problem);
  const bool is_plain = options.loss == Loss::kNone && attempt.drawn == nullptr;
  const bool by_record = RecordsDifferInNoise(attempt, best);
  const bool is_weighted = !is_plain || by_record;
  if (std::isfinite(best.solution.sum_of_squares)) {
    const auto fit_with_weights = [&](ScaledRecords& weighted) {
      solved.is_settled =
          FitWithWeights(best.problem, weighted, options, attempt.drawn, solver,
                         SolverOptionsOf(options), best.solution, solved.noise, by_record);
    };
    if (is_weighted) {
      fit_with_weights(data);
      // Outliers, or the noisiest of the records, may have hidden the initial state: once
      // more from all starts, as weighted.
      if (options.loss != Loss::kNone || by_record) {
        SolvedFit again = FitBestState(attempt);
        if (std::isfinite(again.solution().sum_of_squares)) {
          best = std::move(again.best);
          solved.other_state = again.other_state;
          fit_with_weights(data);
        }
      }
    }
    if (is_plain) {
      solved.turned = TurnedFit(attempt, best);
      if (solved.turned) {
        best.problem.data = solved.turned->records.get();
        best.solution = solved.turned->solution;
        // The weights come from the residuals of the fit whose turning points are the motion's.
        if (by_record) fit_with_weights(*solved.turned->records);
      }
      std::vector<double> of_records = std::move(solved.noise.of_records);
      solved.noise = PlainNoise(*best.problem.data, options, best.solution.sum_of_squares,
                                best.problem.parameters.free().size());
      solved.noise.of_records = std::move(of_records);
    }
  }
  return solved;
}

}  // namespace mindahl::identification
