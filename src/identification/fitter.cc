#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/cycle_energy.h"
#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/diagnosis.h"
#include "identification/diagnosis/discrepancy.h"
#include "identification/diagnosis/grade.h"
#include "identification/diagnosis/law_findings.h"
#include "identification/diagnosis/main_strokes.h"
#include "identification/diagnosis/record_findings.h"
#include "identification/inference/adequacy_test.h"
#include "identification/inference/backlash_trial.h"
#include "identification/inference/covering.h"
#include "identification/inference/displacement_errors.h"
#include "identification/inference/estimates.h"
#include "identification/inference/evidence.h"
#include "identification/inference/irregularities.h"
#include "identification/inference/lag_trial.h"
#include "identification/inference/law_choice.h"
#include "identification/inference/memory_test.h"
#include "identification/inference/noise.h"
#include "identification/inference/profile.h"
#include "identification/inference/record_noise.h"
#include "identification/inference/reweighting.h"
#include "identification/inference/shape_tests.h"
#include "identification/inference/slope_scatter.h"
#include "identification/inference/turning_point_test.h"
#include "identification/intervals.h"
#include "identification/judge/judge.h"
#include "identification/problem/problem.h"
#include "identification/problem/rig_requirement.h"
#include "identification/problem/scaled_records.h"
#include "identification/solve/search.h"
#include "mindahl/core/error.h"
#include "mindahl/core/memory.h"
#include "mindahl/identification/contact_amplitude.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/terms.h"
#include "mindahl/identification/too_few_samples.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {
namespace {

using loop::RecordView;
using models::InitialState;

/// Refuses terms of the force in a fit of the displacement, and terms of the displacement in a fit
/// of the force.
void RequireTermsOfResponse(const FitOptions& options) {
  const bool fits_force = options.response() == loop::Channel::kForce;
  const auto refuse = [&](std::string_view what) {
    throw InvalidArgument(
        fmt::format("{} has no place in a fit of the {}: leave it out, or fit the {}", what,
                    fits_force ? "force" : "displacement", fits_force ? "displacement" : "force"));
  };
  const auto require = [&](const std::string& name) {
    const Term* term = FindTerm(TermNameOf(name), options.response());
    if (term != nullptr && term->presence == Presence::kNever) refuse(name);
  };
  for (const std::string& name : options.terms) require(name);
  for (const auto& [name, value] : options.fixed) require(name);
  if (fits_force) return;
  if (!options.covariates.empty()) refuse("a covariate");
  if (options.force_noise) refuse("noise of the force, which is imposed and taken as exact,");
  if (options.response_noise()) {
    RequirePositive("displacement noise [m]", *options.response_noise());
  }
}

/// The displacement of an imposed force is that of one load.
void RequireOneLoad(const ScaledRecords& data) {
  if (!data.is_forced()) return;
  const bool varies = std::ranges::any_of(
      data.records, [](const ScaledRecord& record) { return !record.load_change.empty(); });
  if (!data.is_load_series && !data.load_varies && !varies) return;
  throw InvalidArgument(
      "the normal load differs or varies, of which a fit of the displacement has no account: fit "
      "the records of one load, or fit the force");
}

void RequireOptions(const FitOptions& options) {
  if (options.model == nullptr || options.model->scaled_by_peak) {
    throw InvalidArgument("the model cannot be fitted: its amplitude must be given");
  }
  if (options.force_noise) RequirePositive("force noise [N]", *options.force_noise);
  if (!(options.confidence > 0 && options.confidence < 1)) {
    ThrowInvalid("confidence [-]", options.confidence, "must be between 0 and 1");
  }
  RequireTermsOfResponse(options);
  if (options.model->memory == models::Memory::kNone && HasTerm(options, "asymmetry") &&
      HasTerm(options, "rig_stiffness")) {
    throw InvalidArgument(fmt::format(
        "asymmetry and rig_stiffness of {}: the rig is compliant to the force, which is not the "
        "state that the law integrates; leave one out, or use --model mindlin-dahl, mindlin or "
        "jenkins",
        options.model->name));
  }
  if (options.max_iterations < 1) {
    ThrowInvalid("maximum iterations [-]", options.max_iterations, "must be >= 1");
  }
  if (options.starts < 1) ThrowInvalid("starts [-]", 0, "must be >= 1");
  if (!options.stated.empty() &&
      (options.loss != Loss::kNone || options.response() != loop::Channel::kForce)) {
    throw InvalidArgument(
        "a stated uncertainty has no place in a fit with a robust loss or of the displacement: "
        "state the value alone");
  }
}

void RequireInitialStates(const FitOptions& options, std::size_t records) {
  const std::size_t states = options.initial_states.size();
  if (states == 0 || states == records) return;
  throw InvalidArgument(
      fmt::format("{} initial states for {} records: give one a record", states, records));
}

/// Beyond it squares overflow; it is a unit that is meant otherwise.
void RequireNoise(const FitOptions& options, const ScaledRecords& data) {
  constexpr double kLargest = 1e100;  // in half ranges of the force
  const std::optional<double> noise = options.response_noise();
  if (!noise || *noise / data.response_unit() < kLargest) return;
  const bool is_forced = data.is_forced();
  ThrowInvalid(is_forced ? "displacement noise [m]" : "force noise [N]", *noise,
               fmt::format("must be below 1e100 times half the range of the {}, {:.4g} {}",
                           is_forced ? "displacement" : "force", data.response_unit(),
                           is_forced ? "m" : "N"));
}

/// Counts the samples left out by reason: "; of 12 that were read 8 are left out: 2 glitches, …".
std::string WhatIsLeftOut(const loop::PreparedRecords& prepared, const FitOptions& fit) {
  const loop::PreparationOptions& options = fit.preparation;
  const std::size_t left_out = prepared.samples() - prepared.counted();
  if (left_out == 0) return "";
  std::size_t glitches = 0;
  for (const loop::PreparedRecord& record : prepared.records) glitches += record.glitches.total();
  std::vector<std::string> reasons;
  if (glitches > 0) reasons.push_back(fmt::format("{} glitches", glitches));
  std::vector<std::string> masks;
  if (options.load_window) masks.emplace_back("outside the load window");
  if (options.skip_cycles > 0) masks.emplace_back("in the cycles that are skipped");
  if (options.cycles) masks.emplace_back("in other cycles than are asked for");
  if (options.samples) masks.emplace_back("other samples than are asked for");
  if (!options.held_out.empty()) masks.emplace_back("held out");
  if (HasTerm(fit, "lag")) masks.emplace_back("beyond the motion that a lag needs");
  if (!masks.empty() && left_out > glitches) {
    reasons.push_back(fmt::format("{} {}", left_out - glitches, fmt::join(masks, " or ")));
  }
  if (reasons.empty()) return "";
  return fmt::format("; of {} that were read {} are left out: {}", prepared.samples(), left_out,
                     fmt::join(reasons, ", "));
}

void RequireEnoughSamples(const Problem& problem, const loop::PreparedRecords& prepared,
                          const FitOptions& options) {
  const std::size_t free = problem.parameters.free().size();
  if (problem.data->counted >= free) return;
  throw TooFewSamples(
      fmt::format("{} samples are too few for {} free parameters{}: record more or fix some",
                  problem.data->counted, free, WhatIsLeftOut(prepared, options)));
}

/// Refuses to fit an asymmetry after slip, where it is confounded with the force's offset.
void RequireToldAsymmetry(const Problem& problem) {
  if (!problem.parameters.asymmetry_is_confounded()) return;
  throw InvalidArgument(
      "asymmetry cannot be distinguished from force_offset: the contact had slipped before what is "
      "fitted, "
      "and both are a force that is always there; give the force's zero where it is known, --fix "
      "force_offset=0, or fit a record from the unloaded contact on, its first loading left in, "
      "with --initial-state virgin");
}

/// Holds the inputs and buffers of a fit while it is made.
struct Attempt {
  const FitOptions& options;
  const loop::PreparedRecords& prepared;
  ScaledRecords& data;
  ThinnedRecords& thin;
  SearchBuffers& buffers;
  std::pmr::memory_resource* memory;
};

/// Returns the initial states that the options name; nothing where both have to be tried.
std::optional<RecordStates> GivenState(const Attempt& attempt) {
  if (!attempt.options.initial_states.empty()) return RecordStates(attempt.options.initial_states);
  if (attempt.options.initial_state) return attempt.options.initial_state;
  const bool unloaded_is_given = std::ranges::any_of(attempt.options.fixed, [&](const auto& fixed) {
    return fixed.first.starts_with(OriginTerm(attempt.data.excitation));
  });
  if (unloaded_is_given) return InitialState::kVirgin;
  const bool any_reversal = std::ranges::any_of(
      attempt.data.records, [](const ScaledRecord& record) { return !record.reversals.empty(); });
  if (!any_reversal) return InitialState::kVirgin;
  return std::nullopt;
}

/// Returns the states of a candidate's records with one of them turned to the other.
RecordStates Flipped(const Problem& problem, std::size_t record) {
  std::vector<InitialState> states;
  states.reserve(problem.data->records.size());
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    states.push_back(problem.state.Of(r));
  }
  states[record] =
      states[record] == InitialState::kVirgin ? InitialState::kSteady : InitialState::kVirgin;
  return RecordStates(std::move(states));
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
/// @param solution  of what is returned
/// @returns nothing where all records stay as they are
template <typename Criterion>
std::optional<Candidate> FitMixedStates(const Attempt& attempt, const Candidate& pure,
                                        const Criterion& criterion, Solution& solution) {
  std::optional<Candidate> best;
  Solution trial_solution;
  constexpr int kMostPasses = 3;
  bool any = true;
  for (int pass = 0; pass < kMostPasses && any; ++pass) {
    any = false;
    for (std::size_t r = 0; r < attempt.data.records.size(); ++r) {
      const Candidate& from = best ? *best : pure;
      Candidate trial(attempt.data, attempt.options, Flipped(from.problem, r), attempt.memory);
      trial.solution = &trial_solution;
      const std::vector<double> start = ThetaFor(trial.problem, from.problem, *from.solution);
      attempt.buffers.solver.Bind(trial.problem, attempt.buffers.response);
      attempt.buffers.solver.Solve(start, SolverOptionsOf(attempt.options), trial_solution);
      const double gain = criterion(from) - criterion(trial);
      if (!(gain > 0) || PastIsUndecided(gain, attempt.options.thresholds)) continue;
      std::swap(solution, trial_solution);
      trial.solution = &solution;
      best.emplace(std::move(trial));
      any = true;
    }
  }
  return best;
}

/// Fits from the initial state that the options name, or that Akaike's criterion prefers; of
/// several records also some as virgin and some as steady, where all as one does not fit.
/// @param rival  written: the other initial state, where the criterion hardly prefers either
Candidate FitBestState(const Attempt& attempt, std::array<Solution, 3>& solutions,
                       std::vector<Descent>* descents, std::optional<Candidate>& rival) {
  const FitOptions& options = attempt.options;
  const auto make = [&](const RecordStates& state, Solution& solution) {
    Candidate candidate(attempt.data, options, state, attempt.memory);
    candidate.solution = &solution;
    RequireEnoughSamples(candidate.problem, attempt.prepared, options);
    return candidate;
  };
  const auto find_starts = [&](Candidate& candidate,
                               double look = std::numeric_limits<double>::infinity()) {
    return FindStartsOf(candidate, attempt.thin, options, look, attempt.buffers, attempt.memory);
  };
  const auto descend = [&](Candidate& candidate, std::vector<Descent>* recorded) {
    AddStartsOfSmallerModels(candidate, attempt.thin, options, attempt.buffers, attempt.memory);
    Descend(candidate, options, attempt.buffers, recorded);
    SearchBesideMinimum(candidate, options, attempt.buffers, recorded);
  };
  if (const std::optional<RecordStates> given = GivenState(attempt)) {
    Candidate candidate = make(*given, solutions[0]);
    find_starts(candidate);
    descend(candidate, descents);
    return candidate;
  }
  Candidate virgin = make(InitialState::kVirgin, solutions[0]);
  Candidate steady = make(InitialState::kSteady, solutions[1]);
  const double virgin_cost = find_starts(virgin);
  const double virgin_look =
      virgin.starts.empty() ? std::numeric_limits<double>::infinity() : virgin.starts.front().look;
  const double steady_cost = find_starts(steady, virgin_look);
  // A rms twice as large on the thinned record is not made good on the whole one: its n_eff·ln 4
  // is beyond the parameter that the two differ by, however few samples are left of it.
  constexpr double kClearlyWorse = 4.0;
  const bool is_one = attempt.data.records.size() == 1;  // of several, some may be of either
  if (is_one && steady_cost > kClearlyWorse * virgin_cost) {
    descend(virgin, descents);
    if (virgin.solution->converged) return virgin;
  } else if (is_one && virgin_cost > kClearlyWorse * steady_cost) {
    descend(steady, descents);
    if (steady.solution->converged) return steady;
  }
  std::vector<Descent> virgin_descents;
  std::vector<Descent> steady_descents;
  descend(virgin, descents != nullptr ? &virgin_descents : nullptr);
  descend(steady, descents != nullptr ? &steady_descents : nullptr);
  const Candidate& better =
      virgin.solution->sum_of_squares < steady.solution->sum_of_squares ? virgin : steady;
  bool is_virgin = true;
  rival.reset();
  bool is_close = false;
  std::optional<Candidate> mixed;
  if (std::isfinite(better.solution->sum_of_squares)) {  // else neither was even started
    const Evidence evidence(attempt.data.counted,
                            EffectiveSamples(better.problem, better.solution->theta,
                                             attempt.buffers.response, attempt.memory));
    const auto criterion = [&](const Candidate& candidate) {
      return evidence.Aicc(candidate.solution->sum_of_squares,
                           candidate.problem.parameters.free().size());
    };
    is_virgin = criterion(virgin) < criterion(steady);
    is_close = PastIsUndecided(criterion(virgin) - criterion(steady), options.thresholds) &&
               virgin.solution->converged && steady.solution->converged;
    if (!is_one) {
      mixed = FitMixedStates(attempt, is_virgin ? virgin : steady, criterion, solutions[2]);
    }
  }
  if (mixed) {
    if (descents != nullptr) {
      *descents = {{.start = mixed->solution->theta,
                    .start_cost = mixed->solution->sum_of_squares,
                    .solution = *mixed->solution}};
    }
    return std::move(*mixed);
  }
  if (descents != nullptr) *descents = is_virgin ? virgin_descents : steady_descents;
  Candidate& chosen = is_virgin ? virgin : steady;
  Candidate& other = is_virgin ? steady : virgin;
  if (is_close) rival.emplace(std::move(other));
  return std::move(chosen);
}

/// The fitted response and residuals as the files have them, of every sample, and their rms.
/// @param residuals  model − measured of every sample, without weights [units of the data]
void FillFitted(const Attempt& attempt, const Problem& problem, std::span<const double> residuals,
                FitResult& result) {
  const ScaledRecords& data = *problem.data;
  double squares = 0.0;
  std::size_t k = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const RecordView& view = attempt.prepared.records[r].record;
    RecordFit& fit = result.records[r];
    const bool is_forced = data.is_forced();
    const std::span<const double> measured = is_forced ? view.displacement : view.force;
    const double unit = is_forced ? data.length : data.sense * data.force;
    std::vector<double>& fitted = is_forced ? fit.fitted_displacement : fit.fitted_force;
    if (is_forced) fit.fitted_force.assign(view.force.begin(), view.force.end());
    fit.residual.resize(measured.size());
    fitted.resize(measured.size());
    std::size_t sample = 0;
    for (std::size_t i = 0; i < record.size(); ++i, ++k) {
      if (!record.inserted.empty() && record.inserted[i] != 0) continue;
      // The difference in units of the data: offsets of the file would cost its digits.
      const double residual = unit * residuals[k];
      fit.residual[sample] = residual;
      fitted[sample] = measured[sample] + residual;
      if (record.counts[i] != 0) squares += residual * residual;
      ++sample;
    }
  }
  result.rms = std::sqrt(squares / static_cast<double>(data.counted));
}

void FillRecords(const Attempt& attempt, Depth depth, FitResult& result) {
  result.records.resize(attempt.prepared.records.size());
  for (std::size_t r = 0; r < result.records.size(); ++r) {
    const loop::PreparedRecord& prepared = attempt.prepared.records[r];
    RecordFit& fit = result.records[r];
    fit.gate = prepared.gate_choice;
    fit.glitches = prepared.glitches;
    fit.reversals.assign(prepared.reversals.begin(), prepared.reversals.end());
    fit.overshoot.clear();
    fit.measures = prepared.measures;
    fit.facts = depth < Depth::kErrors ? loop::LoopFacts()
                                       : loop::MeasureFacts(prepared, attempt.prepared.force_sense);
    fit.displacement_noise = prepared.displacement_noise;
    fit.counts.assign(prepared.counts.begin(), prepared.counts.end());
    fit.left_out = prepared.left_out;
    const ScaledRecords& data = attempt.data;
    fit.normal_load.reset();
    if (!data.mean_load.empty()) fit.normal_load = data.mean_load[r];
    fit.load_ratio = data.records[r].load;
    fit.load_varies = !data.records[r].load_ratio.empty();
    fit.alone.reset();
    fit.structure = {};
    fit.fitted_force.clear();
    fit.fitted_displacement.clear();
    fit.residual.clear();
  }
}

void FillParameters(const Problem& problem, const Solution& solution, FitResult& result) {
  const Parameters& parameters = problem.parameters;
  result.parameters.resize(parameters.reported().size());
  const bool timed = !problem.data->records.front().velocity.empty();
  for (std::size_t k = 0; k < parameters.reported().size(); ++k) {
    const std::size_t p = parameters.reported()[k];
    ParameterEstimate& estimate = result.parameters[k];
    parameters.NameOf(p, estimate.name);
    estimate.unit.assign(parameters.UnitOf(p, timed));
    estimate.value = parameters[p].ToValue(solution.theta[p]);
    estimate.status = StatusOf(parameters[p], solution.side[p]);
    WithdrawInterval(estimate);
    estimate.includes_discrepancy = false;
    estimate.identifiability = Identifiability::kNotIdentifiable;
  }
  result.law = parameters.LawAt(solution.theta);
  result.rig = parameters.RigAt(solution.theta);
  result.load_exponent = parameters.LoadExponentAt(solution.theta);
}

/// Fills what the law loses in each cycle where that changes from cycle to cycle.
void FillLawEnergy(const Attempt& attempt, FitResult& result) {
  const ParameterEstimate* asymmetry = result.Find("asymmetry");
  // In Dahl's own law z² adds as much to the upward stroke as it takes from the downward one.
  const bool is_asymmetric = asymmetry != nullptr && asymmetry->value != 0 &&
                             result.model->memory == models::Memory::kReturnPoint;
  for (std::size_t r = 0; r < result.records.size(); ++r) {
    RecordFit& fit = result.records[r];
    fit.law_energy.clear();
    const bool changes = is_asymmetric && fit.initial_state == InitialState::kVirgin;
    if (!changes || !fit.facts.closed) continue;
    const std::span<const double> displacement = attempt.prepared.records[r].displacement();
    const double first = displacement[fit.facts.cycles.front().start] - displacement.front();
    fit.law_energy = EnergyOfCycles(*result.model, result.LawOf(fit), result.rig,
                                    {.asymmetry = asymmetry->value,
                                     .amplitude = AmplitudeBehindGap(result, fit.facts.amplitude),
                                     .first_direction = first < 0 ? -1 : 1,
                                     .cycles = fit.facts.cycles.size()});
  }
}

/// Those that count: the values themselves where all do, else a copy of some, which is kept.
std::span<const double> Counting(std::span<const double> values, const RecordFit& fit,
                                 std::deque<std::vector<double>>& kept) {
  if (fit.left_out == 0) return values;
  std::vector<double>& counting = kept.emplace_back();
  counting.reserve(values.size() - fit.left_out);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (fit.counts[i] != 0) counting.push_back(values[i]);
  }
  return counting;
}

/// Statistics of the residuals that count, as the files have them.
void DescribeFit(const Attempt& attempt, const Problem& problem, const Noise& noise,
                 FitResult& result) {
  std::deque<std::vector<double>> kept;
  std::vector<std::span<const double>> residuals;
  std::vector<std::span<const double>> measured;
  const bool is_forced = result.response == loop::Channel::kDisplacement;
  for (std::size_t r = 0; r < result.records.size(); ++r) {
    const RecordFit& fit = result.records[r];
    const RecordView& record = attempt.prepared.records[r].record;
    residuals.push_back(Counting(fit.residual, fit, kept));
    measured.push_back(Counting(is_forced ? record.displacement : record.force, fit, kept));
  }
  const double scale =
      is_forced ? result.law.slip_force / result.law.tangential_stiffness : result.law.slip_force;
  result.residuals = DescribeResiduals(residuals, measured, scale);
  result.residuals.effective_samples = noise.effective_samples();
  Noise of_residuals = noise;
  of_residuals.is_known = false;
  const std::size_t free = problem.parameters.free().size();
  result.residuals.degrees_of_freedom = of_residuals.degrees_of_freedom(free);
  result.error_degrees_of_freedom = noise.degrees_of_freedom(free);
}

/// Averages the residuals over strokes; returns the variance inflation by what repeats.
double DescribeStructures(const Problem& problem, std::span<const double> residual,
                          const Thresholds& thresholds, FitResult& result) {
  const bool is_described = result.depth >= Depth::kIntervals;
  double widening = 1.0;
  std::size_t begin = 0;
  for (std::size_t r = 0; r < result.records.size(); ++r) {
    const ScaledRecord& record = problem.data->records[r];
    RecordFit& fit = result.records[r];
    if (!is_described &&
        !AnyComesBack(MainStrokes(record.excitation(), record.reversals, thresholds.main_stroke))) {
      begin += record.size();
      continue;
    }
    std::vector<double> in_si(record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
      in_si[i] = residual[begin + i] * problem.data->response_unit();
    }
    ResidualStructure structure =
        DescribeStructure(record.excitation(), record.reversals, in_si, record.counts,
                          {thresholds.main_stroke, thresholds.repeat_chance});
    widening = std::max(widening, structure.Widening());
    if (is_described) fit.structure = std::move(structure);
    begin += record.size();
  }
  return widening;
}

/// Residuals of which the rms is below this are rounding errors [of the force unit].
constexpr double kOnlyRounding = 10 * kRoundingRms;

void Append(std::vector<Finding>& findings, std::optional<Finding> finding) {
  if (finding) findings.push_back(std::move(*finding));
}

void Append(std::vector<Finding>& findings, std::vector<Finding> more) {
  std::ranges::move(more, std::back_inserter(findings));
}

/// Adequacy, and intervals that cover what its causes would change.
/// @param is_limited  did the search end at a limit of its own?
void ConsiderDepartures(const FittedProblem& fitted, const DisplacementEffect& displacement,
                        bool is_limited, const FitOptions& options, SearchBuffers& buffers,
                        FitResult& result) {
  const auto& [problem, solution, noise, estimates] = fitted;
  const Thresholds& thresholds = options.thresholds;
  // Rounding errors are no noise: nothing is to be learnt from what they look like.
  const double rms =
      std::sqrt(solution.sum_of_squares / static_cast<double>(problem.data->counted));
  if (rms < kOnlyRounding) {
    result.adequacy.verdict = AdequacyVerdict::kAdequate;
    result.adequacy.tried = 1;
    result.adequacy = GradeUse(thresholds, result);
    return;
  }
  AdequacyTest test = TestAdequacy(fitted, displacement, thresholds, buffers.response);
  // A load that varies would have to be read as late.
  if (IsDoubtful(test, thresholds) && !problem.data->load_varies && !problem.data->is_forced()) {
    TryLag(problem, solution, SolverOptionsOf(options), buffers, test);
    DenyLagBeyondKnee(problem, solution, buffers.response, test);
    std::vector<std::optional<loop::Backlash>> gaps;
    gaps.reserve(result.records.size());
    for (const RecordFit& record : result.records) gaps.push_back(record.facts.backlash);
    TryBacklash(problem, solution, gaps, SolverOptionsOf(options), buffers, test);
  }
  std::vector<DepartureFit> causes = CausesOf(test, thresholds);
  result.adequacy = JudgeAdequacy(problem, solution, test, causes, options, result.parameters);
  const Eigen::VectorXd& residual = estimates.residual();
  AddIrregularities(
      problem,
      FindIrregularities(problem, solution.theta, {residual.data(), problem.size()}, noise,
                         options.loss != Loss::kNone,
                         result.adequacy.verdict != AdequacyVerdict::kAdequate, buffers.response),
      options, result.adequacy);
  if (is_limited) result.adequacy.verdict = AdequacyVerdict::kDoubtful;
  if (const auto slow = FindSlowResiduals(result, thresholds)) {
    Append(result.findings, slow);
    result.adequacy.verdict = AdequacyVerdict::kDoubtful;
  }
  result.adequacy = GradeUse(thresholds, result);
  if (result.adequacy.verdict == AdequacyVerdict::kAdequate) return;
  const std::vector<ParameterEstimate> plain = result.parameters;
  WidenByDepartures(problem, solution, causes,
                    StudentQuantile(test.degrees_of_freedom, options.confidence),
                    result.parameters);
  result.parameters[kSlipForce] = CoverPlateau(result, thresholds);
  result.parameters = CoverDiscrepancy(fitted, plain, thresholds, result);
}

/// 1 for samples whose residual is mostly the force's noise; nothing where all are. Where most is
/// the displacement's, residuals are autocorrelated as its errors are, and their draws know that.
std::vector<unsigned char> SamplesOfForceNoise(const ScaledRecords& data, const Noise& noise,
                                               const Thresholds& thresholds) {
  std::vector<unsigned char> tells;
  if (noise.force_share.empty()) return tells;
  for (const ScaledRecord& record : data.records) {
    for (const unsigned char counts : record.counts) {
      const double share = noise.force_share[tells.size()];
      tells.push_back(share * share >= thresholds.force_noise_share ? counts : 0);
    }
  }
  return tells;
}

/// Compares branches with each other, under the fitted law and the other one.
MemoryTest CompareBranches(const FittedProblem& fitted_problem, const LawComparison& laws,
                           const DisplacementEffect& displacement, const Thresholds& thresholds,
                           Response& response) {
  const auto& [problem, solution, noise, estimates] = fitted_problem;
  const FittedLaw fitted{&problem, &solution, estimates.jacobian(), estimates.residual()};
  if (!laws.other) return TestMemory(fitted, nullptr, noise, displacement, thresholds, response);
  const Problem& problem_of_other = laws.other->problem;
  FittedLaw other{&problem_of_other, &laws.other->solution, {}, {}};
  const auto& free = problem_of_other.parameters.free();
  other.jacobian =
      JacobianAt(problem_of_other, other.solution->theta, response, free, other.residual);
  const bool is_masing = problem.model->memory == models::Memory::kReturnPoint;
  const MemoryTest test = TestMemory(is_masing ? fitted : other, is_masing ? &other : &fitted,
                                     noise, displacement, thresholds, response);
  response.Bind(problem);
  return test;
}

/// Estimates the noise and the statistics of the residuals.
/// @param residual  weighted, of every sample
void MeasureNoise(const Attempt& attempt, const Problem& problem, const Solution& solution,
                  std::span<const double> residual, Noise& noise, FitResult& result) {
  const FitOptions& options = attempt.options;
  // Rounding errors are autocorrelated as they like: nothing is to be learnt from them.
  const double rms =
      std::sqrt(solution.sum_of_squares / static_cast<double>(problem.data->counted));
  const bool only_rounding = rms < kOnlyRounding;
  if (!only_rounding) {
    const std::vector<unsigned char> tells =
        SamplesOfForceNoise(*problem.data, noise, options.thresholds);
    noise.autocorrelation = AutocorrelationOf(*problem.data, residual, tells);
  }
  const double repeating = DescribeStructures(problem, residual, options.thresholds, result);
  noise.repeating = only_rounding ? 1.0 : repeating;
  DescribeFit(attempt, problem, noise, result);
}

/// Standard errors, intervals and correlations of the parabola.
void FillErrors(const Problem& problem, const Estimates& estimates, FitResult& result) {
  const auto& reported = problem.parameters.reported();
  for (std::size_t k = 0; k < reported.size(); ++k) {
    estimates.Fill(reported[k], result.parameters[k]);
    for (const std::size_t other : reported) {
      result.correlation.push_back(estimates.Correlation(reported[k], other));
    }
  }
  Append(result.findings, FindUndetermined(problem, estimates.local()));
}

/// Replaces intervals of Tc and σ by those of the likelihood where the parabola may fail.
void WidenByProfiles(const FittedProblem& fitted, const FitOptions& options, SearchBuffers& buffers,
                     FitResult& result) {
  const double peak_force = result.PeakForce();
  const double quantile = fitted.estimates.quantile();
  if (NeedsSlipForceProfile(fitted, peak_force / result.law.slip_force, options, buffers)) {
    SlipForceProfile profile = ProfileSlipForce(fitted, options, buffers);
    const double carried = CarriedForce(fitted.problem, result, peak_force);
    result.parameters =
        WidenByProfile(fitted.problem, profile, quantile, carried, std::move(result.parameters));
    Append(result.findings, FindOpenSlipForce(result, profile));
    result.slip_force_profile = std::move(profile.likelihood);
  }
  result.parameters = ProfileBesideRig(fitted, options, buffers, std::move(result.parameters));
  if (const auto ranges = ProfileSmallShape(fitted, options, buffers)) {
    result.parameters = IncludeSmallShape(fitted.problem, *ranges, std::move(result.parameters));
  }
  if (StiffnessIsOpenAbove(fitted, options, buffers)) {
    OpenAbove(result.parameters[kStiffness], IntervalSource::kProfile);
    result.findings.push_back(FoundOpenStiffness());
  }
}

/// Tests α = 1/3, with a rig and branch by branch.
void TestShape(const Attempt& attempt, const FittedProblem& fitted, FitResult& result) {
  const FitOptions& options = attempt.options;
  const Problem& problem = fitted.problem;
  result.branch_shapes = FitBranchShapes(fitted, attempt.buffers.response);
  result.mindlin_test = TestMindlin(fitted, options, attempt.buffers);
  if (!result.mindlin_test) return;
  if (ContradictsInterval(*result.mindlin_test, *result.Find("alpha"))) {
    result.parameters = WidenByRanges(problem, ProfileShape(fitted, options, attempt.buffers),
                                      fitted.estimates.quantile(), std::move(result.parameters));
    Include(
        result.parameters[kShape],
        {.source = IntervalSource::kProfile, .lower = kMindlinExponent, .upper = kMindlinExponent});
  }
  if (const auto rig =
          TryRig(fitted, attempt.thin, *result.mindlin_test, options, attempt.buffers)) {
    result.mindlin_test->rig_stiffness = rig->rig_stiffness;
    result.findings.push_back(FoundRigAlternative(result, *rig, options.thresholds));
  }
  const bool is_forced = problem.data->is_forced();
  if ((problem.data->load_varies || is_forced) &&
      WantsRig(problem, fitted.solution, *result.mindlin_test, options.thresholds)) {
    result.findings.push_back({.code = "rig_not_tried",
                               .parameters = {"sigma", "alpha"},
                               .numbers = {{"alpha", result.law.shape_exponent}},
                               .kind = is_forced ? "imposed_force" : "varying_load"});
  }
}

/// Extends intervals to the other initial state and to another minimum, which the record does not
/// exclude.
void CoverRivals(const Attempt& attempt, const FittedProblem& fitted, const Candidate* rival,
                 std::span<const Descent> descents, FitResult& result) {
  const auto& [problem, solution, noise, estimates] = fitted;
  const double peak_force = result.PeakForce();
  const auto cover = [&](const Rival& other) {
    return CoverRival(fitted.problem, other, fitted.noise, attempt.options.thresholds, peak_force,
                      attempt.buffers.response, result.parameters);
  };
  if (rival != nullptr) {
    Append(result.findings, FoundUndecidedPast(cover({rival->problem, *rival->solution,
                                                      IntervalSource::kInitialState})));
  }
  for (const Descent& descent : descents) {
    if (!IsAnotherMinimum(problem, solution, descent.solution, noise, result.parameters)) continue;
    Append(result.findings,
           FoundSeveralMinima(cover({problem, descent.solution, IntervalSource::kOtherMinimum})));
    break;  // one says it
  }
}

/// Compares Masing's law with Dahl's own, and branches with each other.
void CompareModels(const Attempt& attempt, const FittedProblem& fitted,
                   const DisplacementEffect& displacement, FitResult& result) {
  const Problem& problem = fitted.problem;
  const LawComparison laws =
      CompareLaws(problem, fitted.solution, result, attempt.options, attempt.buffers);
  if (result.depth >= Depth::kThorough && laws.is_comparable && CanCompareBranches(problem)) {
    result.memory = CompareBranches(fitted, laws, displacement, attempt.options.thresholds,
                                    attempt.buffers.response);
    Append(result.findings, FindContradictedLaw(*result.memory, laws.choice, *result.model));
  }
  result.law_choice = ReportedLaw(laws.choice, result.adequacy.verdict);
  Append(result.findings, FindOtherLaw(result.law_choice));
}

/// Noise, errors, intervals and residuals and, by the depth, adequacy, profiles and tests: each
/// depth does what the one before does, and more.
/// @param at     the problem by all its free parameters, at the solution
/// @param rival     the other initial state, where the record hardly determines it; else null
/// @param descents  what other starts of this problem led to
void Infer(const Attempt& attempt, const Problem& problem, const Solution& solution,
           Linearization at, Noise& noise, const DisplacementErrors& displacement_errors,
           const Candidate* rival, std::span<const Descent> descents, FitResult& result) {
  const FitOptions& options = attempt.options;
  const Thresholds& thresholds = options.thresholds;
  SearchBuffers& buffers = attempt.buffers;
  const bool is_judged = result.depth >= Depth::kIntervals;
  const bool is_tested = result.depth >= Depth::kFull;
  MeasureNoise(attempt, problem, solution, {at.residual.data(), problem.size()}, noise, result);
  const DisplacementEffect displacement = EffectOf(displacement_errors, problem, solution, noise);
  const Estimates estimates(problem, solution, noise, displacement, thresholds, std::move(at));
  const FittedProblem fitted{problem, solution, noise, estimates};
  FillErrors(problem, estimates, result);
  WidenByProfiles(fitted, options, buffers, result);
  if (is_tested) TestShape(attempt, fitted, result);
  if (is_judged) CoverRivals(attempt, fitted, rival, descents, result);
  const std::optional<Finding> limit = FindSearchLimit(problem, solution);
  Append(result.findings, limit);
  if (is_judged) {
    ConsiderDepartures(fitted, displacement, limit.has_value(), options, buffers, result);
  }
  result.parameters[kStiffness] = CoverSlipFactor(
      problem, solution, std::move(result.parameters[kStiffness]), buffers.response);
  result.parameters[kSlipForce] = KeepAboveCarriedForce(result);
  Append(result.findings, FindUnseenLoop(result, thresholds));
  Append(result.findings, FindWideIntervals(result, thresholds));
  if (is_judged) {
    if (!options.initial_state && options.initial_states.empty()) {
      Append(result.findings, FindUnknownPast(problem, solution, thresholds));
    }
    Append(result.findings, FindNoisierDisplacement(attempt.prepared, result, thresholds));
    Append(result.findings, FindFewPlaces(problem, thresholds));
  }
  Append(result.findings, FindUntoldAsymmetry(result, thresholds));
  if (is_judged) Append(result.findings, FindShapeLimitedByLoad(problem, solution));
  Append(result.findings, FindExtrapolated(result, thresholds));
  if (is_judged) {
    Append(result.findings, FindMisfit(result, thresholds));
    Append(result.findings, FindEnergyContradiction(result, thresholds));
  }
  result.findings = WithoutNeedless(result.parameters, std::move(result.findings));
  if (is_judged && IsInadequate(result, thresholds)) {
    result = WithoutInadequate(std::move(result), thresholds);
  }
  if (is_tested) CompareModels(attempt, fitted, displacement, result);
  Judge(result.parameters, result.findings);
}

void ReportStarts(const Problem& problem, const std::vector<Descent>& descents, FitResult& result) {
  const auto rms = [&](double sum_of_squares) {
    return problem.data->response_unit() *
           std::sqrt(sum_of_squares / static_cast<double>(problem.data->counted));
  };
  for (const Descent& descent : descents) {
    if (descent.is_rival) continue;
    result.starts.push_back({.drawn = descent.drawn,
                             .start = problem.parameters.LawAt(descent.start),
                             .initial_rms = rms(descent.start_cost),
                             .reached = problem.parameters.LawAt(descent.solution.theta),
                             .final_rms = rms(descent.solution.sum_of_squares),
                             .converged = descent.solution.converged});
  }
}

/// Returns options to fit one record of a load series, all shared parameters held.
FitOptions OptionsAlone(const FitOptions& options, const FitResult& series, std::size_t r) {
  FitOptions alone = options;
  alone.normal_loads = {*series.records[r].normal_load};
  alone.initial_states = {series.records[r].initial_state};
  alone.preparation.force_sense = series.force_sense;
  alone.preparation.held_out.clear();
  if (r < options.preparation.held_out.size()) {
    alone.preparation.held_out = {options.preparation.held_out[r]};
  }
  alone.start.clear();
  alone.stated.clear();
  std::erase_if(alone.terms,
                [](const std::string& name) { return FindTerm(name)->scope == Scope::kContact; });
  // A record's own lose their number, those of the others go.
  const auto translate = [&](auto& values) {
    std::remove_reference_t<decltype(values)> own;
    for (const auto& [name, value] : values) {
      const std::string term(TermNameOf(name));
      if (FindTerm(term)->scope == Scope::kRecord && name == fmt::format("{}_{}", term, r + 1)) {
        own.emplace(term, value);
      }
    }
    values = std::move(own);
  };
  translate(alone.fixed);
  translate(alone.bounds);
  for (const ParameterEstimate& estimate : series.parameters) {
    const Term* term = FindTerm(estimate.name);
    const bool is_shared = term != nullptr && term->scope == Scope::kContact;
    const bool is_own = estimate.name == "sigma" || estimate.name == "slip_force" ||
                        estimate.name == "load_exponent";
    if (is_shared && !is_own) alone.fixed[estimate.name] = estimate.value;
  }
  return alone;
}

/// Fits each record of a load series by itself.
void FitRecordsAlone(std::span<const RecordView> records, const FitOptions& options,
                     FitResult& series) {
  for (std::size_t r = 0; r < records.size(); ++r) {
    try {
      Fitter fitter(OptionsAlone(options, series, r));
      const FitResult& fit = fitter.Fit(records[r], Depth::kIntervals);
      if (!fit.converged) continue;
      series.records[r].alone = {*fit.Find("sigma"), *fit.Find("slip_force")};
    } catch (const InvalidArgument&) {
      continue;  // few samples, a loop stiffer than the rig: by itself no fit, as documented
    }
  }
}

/// The options with a slip force no larger than the largest force of the record, where the loop
/// slides over most of its stroke and the fitted law, which is not adequate, carries its slip force
/// nowhere: the loop has carried it. Nothing where that is not so or the user limits Tc.
std::optional<FitOptions> WithinMeasuredForce(const FitResult& result, const FitOptions& given) {
  constexpr const char* kName = "slip_force";
  // Below, nothing says that the model does not follow the record.
  if (result.depth < Depth::kIntervals) return std::nullopt;
  if (result.adequacy.verdict == AdequacyVerdict::kAdequate || result.parameters.empty() ||
      result.response == loop::Channel::kDisplacement || given.bounds.contains(kName) ||
      given.fixed.contains(kName)) {
    return std::nullopt;
  }
  const RecordFit& widest = result.WidestRecord();
  if (!SlidesOverMostOfStroke(widest.facts, given.thresholds) || IsScaledByLoad(result)) {
    return std::nullopt;
  }
  const double peak_force = widest.facts.peak_force / widest.load_ratio;
  if (peak_force >= given.thresholds.mobilised_by_asymptote * result.law.slip_force) {
    return std::nullopt;
  }
  FitOptions within = given;
  within.start.clear();
  within.bounds[kName] = {0.0, peak_force};
  return within;
}

/// True if the record determines the law, as far as the depth shows. Where it does not, the
/// likelihood is a valley with several minima.
bool TellsTheLaw(const FitResult& result) {
  if (result.depth < Depth::kErrors) return true;
  return std::ranges::all_of(result.parameters, [](const ParameterEstimate& estimate) {
    const bool is_of_law =
        estimate.name == "sigma" || estimate.name == "alpha" || estimate.name == "slip_force";
    return !is_of_law || estimate.is_known();
  });
}

/// True if the noise of the records is not one, where it is not known.
bool RecordsDifferInNoise(const Attempt& attempt, const Candidate& candidate) {
  const Problem& problem = candidate.problem;
  const bool is_known = attempt.options.response_noise().has_value();
  if (is_known || problem.data->records.size() < 2 ||
      !std::isfinite(candidate.solution->sum_of_squares)) {
    return false;
  }
  std::pmr::vector<double> residual(problem.size(), attempt.memory);
  EvaluateResidual(problem, candidate.solution->theta, attempt.buffers.response, residual);
  return ChanceOfOneNoise(problem, residual) < attempt.options.thresholds.noise_differs;
}

/// Solves a candidate whose weights or samples have changed, from where it is.
void SolveAgain(Candidate& candidate, const FitOptions& options, SearchBuffers& buffers) {
  buffers.solver.Bind(candidate.problem, buffers.response);
  const std::vector<double> start = candidate.solution->theta;
  buffers.solver.Solve(start, SolverOptionsOf(options), *candidate.solution);
}

/// Returns the noise of the force [N] against which stated values weigh: as it is known, else what
/// a fit with the values held leaves.
double StatedNoise(std::span<const RecordView> records, const FitOptions& options) {
  if (options.force_noise) return *options.force_noise;
  FitOptions held = options;
  held.stated.clear();
  for (const auto& [name, stated] : options.stated) {
    std::erase(held.terms, name);
    held.start.erase(name);
    held.fixed.emplace(name, stated.value);
  }
  return Fitter(held).Fit(records, Depth::kEstimate).rms;
}

}  // namespace

struct Fitter::State {
  explicit State(FitOptions given) : options(std::move(given)), continued(options) {
    RequireOptions(options);
  }

  void Fit(std::span<const RecordView> records, Depth depth, const FitOptions& given);
  /// Fits, and once more where the slip force runs away from what was measured, and where the
  /// residuals scatter as noise of the displacement makes them.
  void FitWithin(std::span<const RecordView> records, Depth depth, const FitOptions& given) {
    Fit(records, depth, given);
    std::optional<FitOptions> within = WithinMeasuredForce(result, given);
    if (within) Fit(records, depth, *within);
    TryDisplacementNoise(records, depth, within ? *within : given);
  }
  /// Fits with the noise of the displacement that the residuals show, and keeps that where it is
  /// adequate.
  void TryDisplacementNoise(std::span<const RecordView> records, Depth depth,
                            const FitOptions& given);
  void Continue(const RecordView& record, Depth depth);
  [[nodiscard]] bool MayContinue() const;

  FitOptions options;
  FitOptions continued;  // the same, from where the last fit ended
  Arena arena;
  SearchBuffers buffers;
  std::array<Solution, 3> solutions;  // of the pasts that are tried
  std::vector<Descent> descents;
  FitResult result;
  std::optional<SlopeScatter> scatter;  // of the last fit; looked for from kIntervals on
};

void Fitter::State::Fit(std::span<const RecordView> records, Depth depth, const FitOptions& given) {
  arena.Reset();
  // A new result, in the memory of the last.
  FitResult fresh;
  fresh.depth = depth;
  fresh.model = given.model;
  fresh.response = given.response();
  fresh.parameters.swap(result.parameters);
  fresh.correlation.swap(result.correlation);
  fresh.records.swap(result.records);
  fresh.solver.message.swap(result.solver.message);
  fresh.solver.message.assign("not run");
  fresh.correlation.clear();
  result = std::move(fresh);
  descents.clear();
  scatter.reset();
  RequireInitialStates(given, records.size());

  loop::PreparedRecords prepared = loop::Prepare(records, given.preparation, &arena);
  LeaveOutBeyondLags(given, prepared);
  ScaledRecords data = Scale(prepared, given, &arena);
  AddCovariates(given.covariates, depth >= Depth::kIntervals, prepared, given.offsets, data);
  AddColumnsOfTerms(given, data);
  data.stated_noise = given.stated.empty() ? 0.0 : StatedNoise(records, given) / data.force;
  if (HasTerm(given, "lag")) SetClocks(data);
  ThinnedRecords thin(data, &arena);
  const Attempt attempt{given, prepared, data, thin, buffers, &arena};
  RequireOneLoad(data);
  RequireRigStifferThanLoop(given, prepared);
  RequireNoise(given, data);
  result.force_sense = prepared.force_sense;
  result.confidence = given.confidence;
  FillRecords(attempt, depth, result);
  if (!data.mean_load.empty()) result.normal_load = data.reference_load;

  const bool is_judged = depth >= Depth::kIntervals;
  if (is_judged) {
    result.findings = FindInRecords(result.records, given.thresholds, data.excitation);
    Append(result.findings, FindVaryingLoads(data));
  }
  std::vector<Descent>* const recorded = is_judged ? &descents : nullptr;
  std::optional<Candidate> rival;
  std::optional<Candidate> best(FitBestState(attempt, solutions, recorded, rival));
  RequireToldAsymmetry(best->problem);
  const DisplacementErrors displacement_errors(prepared, data);
  const bool is_plain = given.loss == Loss::kNone && !displacement_errors.any();
  const bool by_record = RecordsDifferInNoise(attempt, *best);
  const bool is_weighted = !is_plain || by_record;
  Noise noise;
  bool settled = true;
  std::optional<TurningPointFit> turned;
  if (std::isfinite(best->solution->sum_of_squares)) {
    if (is_weighted) {
      const auto fit_with_weights = [&] {
        settled = FitWithWeights(best->problem, data, given, displacement_errors, buffers.solver,
                                 buffers.response, SolverOptionsOf(given), *best->solution, noise,
                                 by_record);
      };
      fit_with_weights();
      // Outliers, or the noisiest of the records, may have hidden the initial state: once
      // more from all starts, as weighted.
      if (given.loss != Loss::kNone || by_record) {
        ThinnedRecords weighted_thin(data, &arena);
        const Attempt weighted{given, prepared, data, weighted_thin, buffers, &arena};
        descents.clear();
        best.emplace(FitBestState(weighted, solutions, recorded, rival));
        fit_with_weights();
        if (rival && by_record) SolveAgain(*rival, given, buffers);
      }
    }
    if (is_plain) {
      // A gate means noise in the displacement: its outermost samples are the noisiest, and say
      // nothing of where the motion turned.
      const bool gated = std::ranges::any_of(
          prepared.records, [](const auto& record) { return record.reversal_gate > 0; });
      // Turning points are not fitted together with a term that moves the samples off them.
      const bool is_moved = best->problem.parameters.moves_contact();
      // Nor under a load that varies: the path between the samples is not the displacement's alone.
      // An imposed force is taken as it was sampled.
      if (best->solution->converged && !gated && !is_moved && !data.load_varies &&
          !data.is_forced()) {
        turned = FitTurningPointsIfNeeded(best->problem, *best->solution, given, buffers);
      }
      if (turned) {
        best->problem.data = &turned->records->data;
        *best->solution = turned->solution;
        if (rival && !best->problem.data->turns_are_fitted) {
          rival->problem.data = &turned->records->data;
          SolveAgain(*rival, given, buffers);
        }
        // By what is left where the turning points are where the motion has them.
        if (by_record && !best->problem.data->turns_are_fitted) {
          settled = FitWithWeights(best->problem, turned->records->data, given, displacement_errors,
                                   buffers.solver, buffers.response, SolverOptionsOf(given),
                                   *best->solution, noise, by_record);
        }
      }
      std::vector<double> of_records = std::move(noise.of_records);
      noise = PlainNoise(
          *best->problem.data, given, best->solution->sum_of_squares,
          best->problem.parameters.free().size() +
              (best->problem.data->turns_are_fitted ? turned->records->overshoot.size() : 0));
      noise.of_records = std::move(of_records);
    }
  }
  const Solution& solution = *best->solution;
  const bool any_virgin = best->problem.state.Any(InitialState::kVirgin);
  result.initial_state = any_virgin ? InitialState::kVirgin : InitialState::kSteady;
  for (std::size_t r = 0; r < result.records.size(); ++r) {
    const double own = noise.of_records.empty() ? noise.force : noise.of_records[r];
    result.records[r].initial_state = best->problem.state.Of(r);
    result.records[r].response_noise = own * data.response_unit();
  }
  result.solver = solution.report;
  const double unit_squared = data.response_unit() * data.response_unit();
  result.solver.initial_cost *= unit_squared;
  result.solver.final_cost *= unit_squared;
  result.converged = solution.converged;
  if (is_judged) ReportStarts(best->problem, descents, result);
  if (!std::isfinite(solution.sum_of_squares)) {
    result.converged = false;
    result.parameters.clear();  // otherwise their names' memory is used again
    result.findings.push_back({.code = "fit_failed"});
    return;
  }
  if (!settled) {
    result.converged = false;
    result.solver.termination = "NO_CONVERGENCE";
    result.solver.message = "The weights of the samples did not settle.";
    result.findings.push_back({.code = "weights_not_settled"});
  }
  if (data.is_forced()) {
    for (RecordFit& fit : result.records) fit.displacement_noise = noise.force * data.length;
  } else {
    result.force_noise = noise.force * data.force;
  }
  result.outliers = noise.outliers;
  FillParameters(best->problem, solution, result);
  FillLawEnergy(attempt, result);
  Linearization at;
  if (depth >= Depth::kErrors) {
    at = LinearizeAt(best->problem, solution.theta, buffers.response,
                     best->problem.parameters.free());
  }
  // If all samples count the same, the solution has their residuals.
  if (!is_weighted && !turned && data.counted == data.samples() && !solution.residual.empty()) {
    FillFitted(attempt, best->problem, solution.residual, result);
  } else {
    std::pmr::vector<double> residuals(best->problem.size(), &arena);
    buffers.response.Bind(best->problem);
    Predict(best->problem, solution.theta, buffers.response, residuals);
    TakeOffMeasured(*best->problem.data, residuals);
    FillFitted(attempt, best->problem, residuals, result);
  }
  const bool fits_turns = best->problem.data->turns_are_fitted;
  if (fits_turns) {
    std::size_t k = 0;
    double longest = 0.0;
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      for (std::size_t j = 0; j < data.records[r].reversals.size(); ++j) {
        const double overshoot = turned->records->overshoot[k++] * data.length;
        result.records[r].overshoot.push_back(overshoot);
        longest = std::max(longest, overshoot);
      }
    }
    result.findings.push_back(FoundTurningPoints(longest));
  }
  if (is_judged && !given.preparation.displacement_noise && noise.force > kOnlyRounding) {
    scatter = FindSlopeScatter(prepared, best->problem, solution.theta,
                               {at.residual.data(), best->problem.size()}, buffers.response);
  }
  if (depth >= Depth::kErrors) {
    Infer(attempt, best->problem, solution, std::move(at), noise, displacement_errors,
          rival && !fits_turns ? &*rival : nullptr,
          fits_turns || is_weighted ? std::span<const Descent>() : descents, result);
  }
  if (depth >= Depth::kFull && data.is_load_series) FitRecordsAlone(records, given, result);
}

void Fitter::State::TryDisplacementNoise(std::span<const RecordView> records, Depth depth,
                                         const FitOptions& given) {
  if (!scatter || !result.converged) return;
  const bool is_doubted = result.adequacy.verdict != AdequacyVerdict::kAdequate;
  const std::optional<double> noise = NoiseToTry(*scatter, is_doubted, given.thresholds);
  if (!noise) return;
  FitOptions with_noise = given;
  with_noise.preparation.displacement_noise = noise;
  const SlopeScatter found = *scatter;
  FitResult plain = result;
  Fit(records, depth, with_noise);
  if (!result.converged || result.adequacy.verdict != AdequacyVerdict::kAdequate) {
    result = std::move(plain);
    return;
  }
  result.findings.push_back({.code = "displacement_noise_estimated",
                             .numbers = {{"deviation", *noise}, {"p", found.p_value}}});
}

/// True if the next fit may start at the last one's end: a single minimum, not at a bound.
bool Fitter::State::MayContinue() const {
  return result.converged && options.starts == 1 && TellsTheLaw(result) &&
         std::ranges::none_of(result.parameters, [](const ParameterEstimate& estimate) {
           return estimate.status == ParameterStatus::kAtLowerBound ||
                  estimate.status == ParameterStatus::kAtUpperBound ||
                  (estimate.name == "alpha" && estimate.status == ParameterStatus::kFixed &&
                   estimate.value == 0);
         });
}

void Fitter::State::Continue(const RecordView& record, Depth depth) {
  if (MayContinue()) {
    for (const ParameterEstimate& estimate : result.parameters) {
      if (estimate.status == ParameterStatus::kFixed) continue;
      const Term& term = *FindTerm(TermNameOf(estimate.name), options.response());
      if (term.entry == Entry::kLaw || estimate.name == "slip_force") {
        continued.start[estimate.name] = estimate.value;
      }
    }
    const double last_rms = result.rms;
    FitWithin({&record, 1}, depth, continued);
    constexpr double kAsGood = 1.5;  // times the last rms
    if (result.converged && result.rms <= kAsGood * last_rms && TellsTheLaw(result)) return;
  }
  FitWithin({&record, 1}, depth, options);
}

Fitter::Fitter(FitOptions options) : state_(std::make_unique<State>(std::move(options))) {}
Fitter::Fitter(Fitter&&) noexcept = default;
Fitter& Fitter::operator=(Fitter&&) noexcept = default;
Fitter::~Fitter() = default;

const FitOptions& Fitter::options() const { return state_->options; }

const FitResult& Fitter::Fit(std::span<const RecordView> records, Depth depth) {
  state_->FitWithin(records, depth, state_->options);
  return state_->result;
}

const FitResult& Fitter::Continue(const RecordView& record, Depth depth) {
  state_->Continue(record, depth);
  return state_->result;
}

FitResult Fit(std::span<const loop::Record> records, const FitOptions& options, Depth depth) {
  std::vector<RecordView> views(records.begin(), records.end());
  Fitter fitter(options);
  return fitter.Fit(views, depth);
}

}  // namespace mindahl::identification
