#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/continued_fit.h"
#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/diagnosis.h"
#include "identification/diagnosis/hull.h"
#include "identification/gram/omitted_terms.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/inference/profile.h"
#include "identification/problem/problem.h"
#include "identification/problem/scaled_records.h"
#include "identification/solved_fit.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {
namespace {

using loop::RecordView;
using models::InitialState;

/// Refuses loads that vary in a fit of the displacement, and noise whose squares overflow.
void RequireRecords(const FitOptions& options, const ScaledRecords& data) {
  const bool varies = std::ranges::any_of(
      data.records, [](const ScaledRecord& record) { return !record.load_change.empty(); });
  if (data.is_forced() && (data.is_load_series || data.load_varies || varies)) {
    throw InvalidArgument(
        "the normal load differs or varies, which a fit of the displacement does not model: fit "
        "the records of one load, or fit the force");
  }
  const std::optional<double> noise = options.response_noise();
  if (!noise || *noise / data.response_unit() < 1e100) return;
  ThrowInvalid(data.is_forced() ? "displacement noise [m]" : "force_noise [N]", *noise,
               "must be below 1e100 times half the range of the records");
}

/// Refuses a rig that is given and softer than the loop itself from end to end, T*/X: in series
/// with it no contact, however stiff, makes the record.
void RequireRigStifferThanLoop(const FitOptions& options, const loop::PreparedRecords& records) {
  const auto rig = options.fixed.find("rig_stiffness");
  if (rig == options.fixed.end()) return;  // one with a prior is fitted
  for (const loop::PreparedRecord& record : records.records) {
    const double stiffness = record.facts.peak_force / record.facts.amplitude;
    if (!(rig->second > 0) || !(rig->second <= stiffness)) continue;
    ThrowInvalid("rig_stiffness [N/m]", rig->second,
                 fmt::format("must be > {:.4g}, the stiffness of the loop itself from end to end: "
                             "measure the rig again, or fit it",
                             stiffness));
  }
}

/// Measures the loops without forces whose factors are given: what is left is the contact's.
void MeasureBesideKnownForces(const FitOptions& options, const ScaledRecords& data,
                              loop::PreparedRecords& prepared) {
  if (options.fixed.empty() || data.is_forced()) return;
  const Problem problem(data, options, InitialState::kVirgin);
  const Parameters& parameters = problem.parameters;
  const std::vector<double> theta = parameters.Theta();
  Eigen::VectorXd known = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const Term& term = *parameters[p].term;
    const bool is_shaped = std::ranges::any_of(parameters.free(), [&](std::size_t q) {
      const std::string_view shapes = parameters[q].term->shapes;
      return !shapes.empty() && term.name.starts_with(shapes);
    });
    if (!term.adds_force() || !parameters[p].fixed || theta[p] == 0 || is_shaped) continue;
    AddColumn(problem, p, theta, -theta[p] * data.force * prepared.force_sense, known);
  }
  if (known.isZero(0.0)) return;
  for (std::size_t r = 0; r < prepared.records.size(); ++r) {
    loop::PreparedRecord& record = prepared.records[r];
    loop::RecordView contact = record.readings();
    contact.displacement = record.displacement();
    const std::span<double> force = data.records[r].Of(SpanOf(known));
    std::ranges::transform(force, contact.force, force.begin(), std::plus());
    contact.force = force;
    record.facts =
        loop::MeasureFacts(contact, record.reversals, prepared.force_sense, record.counts);
  }
}

/// Fills the fitted response and the residuals of every sample as the files have them; their rms.
void FillFitted(const Attempt& attempt, const SolvedFit& solved, FitResult& result) {
  const auto& [problem, starts, solution] = solved.best;
  const ScaledRecords& data = *problem.data;
  Eigen::VectorXd residuals = Predict(problem, solution.theta) - data.All(&ScaledRecord::response);
  const std::span<double> of_all = SpanOf(residuals);
  const bool is_forced = data.is_forced();
  const double unit = is_forced ? data.length : data.force * attempt.prepared.force_sense;
  double squares = 0.0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const RecordView& view = attempt.prepared.records[r].record;
    RecordFit& fit = result.records[r];
    std::vector<double>& fitted = is_forced ? fit.fitted_displacement : fit.fitted_force;
    if (is_forced) fit.fitted_force.assign(view.force.begin(), view.force.end());
    for (std::size_t i = 0; i < record.size(); ++i) {
      // The difference in units of the data: offsets of the file would cost its digits.
      const double residual = unit * record.Of(of_all)[i];
      fitted.push_back((is_forced ? view.displacement : view.force)[i] + residual);
      fit.residual.push_back(residual);
      if (record.counts[i] != 0) squares += residual * residual;
    }
  }
  result.rms = std::sqrt(squares / static_cast<double>(data.counted));
  result.likelihood_rms = result.rms;
  if (!attempt.options.preparation.drawn || attempt.options.loss != Loss::kNone) return;
  double log_weights = 0.0;
  for (const double weight : data.All(&ScaledRecord::root_weight)) {
    log_weights += weight > 0 ? std::log(weight) : 0;
  }
  const double squares_of_priors = problem.parameters.PriorCost(solution.theta);
  const auto count = static_cast<double>(data.counted);
  result.likelihood_rms = data.response_unit() * std::exp(-log_weights / count) *
                          std::sqrt((solution.sum_of_squares - squares_of_priors) / count);
}

/// Assembles what a solution says by itself, and what the records show without a model.
FitResult Assemble(const Attempt& attempt, const SolvedFit& solved) {
  const ScaledRecords& data = attempt.data;
  const Problem& problem = solved.best.problem;
  const Solution& solution = solved.solution();
  FitResult result;
  result.depth = attempt.depth;
  result.model = attempt.options.model;
  result.response = attempt.options.response();
  result.confidence = attempt.options.confidence;
  result.force_sense = attempt.prepared.force_sense;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    RecordFit& fit = result.records.emplace_back();
    static_cast<loop::RecordReading&>(fit) = attempt.prepared.records[r];
    fit.turns_between = data.records[r].turns_between;
    if (data.is_forced()) fit.displacement_noise = solved.noise.force * data.length;
    if (!data.mean_load.empty()) fit.normal_load = data.mean_load[r];
    fit.load_ratio = data.records[r].load;
    fit.load_varies = !data.records[r].load_ratio.empty();
  }
  if (!data.mean_load.empty()) result.normal_load = data.reference_load;
  result.findings = FindMissingRows(attempt.prepared.records);
  if (attempt.depth >= Depth::kIntervals) {
    Append(result.findings, FindInRecords(result.records));
    Append(result.findings, FindVaryingLoads(data));
  }
  result.initial_state = problem.initial_state;
  result.solver = solution.report;
  if (!std::isfinite(solution.sum_of_squares)) {
    result.findings.push_back(
        {.code = "not_converged", .severity = Severity::kFailure, .kind = "failed"});
    return result;
  }
  result.converged = solution.converged && solved.is_settled;
  result.solver.final_cost =
      solution.sum_of_squares / 2 * (data.response_unit() * data.response_unit());
  if (!solved.is_settled) {
    result.solver.termination = "NO_CONVERGENCE";
    result.solver.message = "The weights of the samples did not settle.";
    result.findings.push_back({.code = "not_converged", .kind = "weights"});
  }
  if (!data.is_forced()) result.force_noise = solved.noise.force * data.force;
  result.outliers = solved.noise.outliers;
  const Parameters& parameters = problem.parameters;
  result.parameters = ValuesOf(problem, solution);
  result.law = parameters.LawAt(solution.theta);
  result.rig = parameters.RigAt(solution.theta);
  result.load_exponent = parameters.LoadExponentAt(solution.theta);
  FillFitted(attempt, solved, result);
  return result;
}

/// Adds to what a solution says by itself its noise, errors and intervals and, by the depth,
/// adequacy, profiles and tests.
void Infer(const Attempt& attempt, SolvedFit& solved, FitResult& result) {
  const ScaledRecords& data = attempt.data;
  const Problem& problem = solved.best.problem;
  const Solution& solution = solved.solution();
  const Thresholds& thresholds = attempt.options.thresholds;
  // Rounding errors are no noise: nothing is to be learnt from what they look like.
  const double rms = std::sqrt(solution.sum_of_squares / static_cast<double>(data.counted));
  const bool is_rounding = rms < 10 * kRoundingRms;
  Linearization at = Response(problem).LinearizeAt(solution.theta, problem.parameters.free());
  const std::span<const double> residual = SpanOf(at.residual);
  Noise& noise = solved.noise;
  double widening = 1.0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    ResidualStructure& structure = result.records[r].structure;
    structure = DescribeStructure(data.records[r], data.records[r].Of(residual), thresholds);
    widening = std::max(widening, structure.Widening());
  }
  if (!is_rounding) {
    noise.autocorrelation = EstimateAutocorrelation(data.records, residual);
    noise.repeating = widening;
    const bool any_differs = data.records.size() > 1 && !noise.is_known;
    if (any_differs) noise.of_records = VariancesOfRecords(data, residual);
  }
  result.residuals = DescribeResiduals(result.records);
  result.residuals.effective_samples = noise.effective_samples();
  result.degrees_of_freedom = noise.degrees_of_freedom(problem.parameters.free().size());
  const Estimates fitted(problem, solution, noise, attempt.options, std::move(at));
  const std::vector<std::size_t>& reported = problem.parameters.reported();
  for (std::size_t k = 0; k < reported.size(); ++k) {
    fitted.Fill(reported[k], result.parameters[k]);
    for (const std::size_t other : reported) {
      result.correlation.push_back(fitted.Correlation(reported[k], other));
    }
  }
  Append(result.findings, FindUndetermined(fitted));
  ProfileIntervals(fitted, result);
  if (result.depth >= Depth::kFull) {
    Append(result.findings, IncludeCompliantRig(fitted, result.parameters));
  }
  if (solved.of_other_state) IncludeLaw(*solved.of_other_state, result.parameters);
  if (!data.is_forced()) CoverSteps(attempt.prepared, result);
  const std::vector<Finding> limit = FindSearchLimit(problem, solution);
  Append(result.findings, limit);
  if (result.depth >= Depth::kIntervals && is_rounding) {
    result.adequacy.tried = 1;
    GradeUse(thresholds, result);
  } else if (result.depth >= Depth::kIntervals) {
    const AdequacyTest test = TestAdequacy(fitted);
    result.adequacy = test.adequacy;
    JudgeAdequacy(/*is_limited=*/!limit.empty(), thresholds, result);
    GradeUse(thresholds, result);
    if (MayOmitTerms(result.adequacy, thresholds)) {
      const double quantile = StudentQuantile(test.degrees_of_freedom, result.confidence);
      WidenByOmittedTerms(problem, solution, test, quantile, result.parameters);
    }
    if (result.adequacy.verdict != AdequacyVerdict::kAdequate) CoverDiscrepancy(fitted, result);
  }
  KeepAboveCarriedForce(problem.parameters, result);
  Append(result.findings, FindOnParameters(fitted, attempt.prepared, result));
  WithdrawIfInadequate(thresholds, result);
  Append(result.findings, FindWideIntervals(result, thresholds));
  Judge(result.parameters, result.findings);
}

/// True if the record determines the law, as far as the depth shows: else there are several minima.
bool TellsTheLaw(const FitResult& result) {
  return result.depth < Depth::kErrors ||
         std::ranges::all_of(result.parameters | std::views::take(kSlipForce + 1),
                             &ParameterEstimate::is_known);
}

/// Returns the first strokes of records that begin on their later loop and fit worse than the rest:
/// the last turn before them may have been elsewhere than the later ones.
std::vector<SampleRange> FirstStrokesAside(const ScaledRecords& data, const FitResult& result,
                                           const Thresholds& thresholds) {
  std::vector<SampleRange> aside;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const RecordFit& fit = result.records[r];
    if (record.CountTurns() < 2 || !record.BeginsOnLoop()) continue;
    const auto rms = [&](std::size_t begin, std::size_t end) {  // of samples that count
      double squares = 0.0;
      double count = 0.0;
      for (std::size_t i = begin; i < end; ++i) {
        squares += fit.counts[i] * fit.residual[i] * fit.residual[i];
        count += fit.counts[i];
      }
      return std::sqrt(squares / std::max(count, 1.0));
    };
    const std::size_t turn = record.reversals.front();
    if (rms(0, turn) > thresholds.larger_rms * rms(turn, record.size())) {
      aside.push_back({r, 0, turn});
    }
  }
  return aside;
}

/// Fits once, with the slip force wherever the search finds it; where a first stroke does not fit,
/// without it, if then all is described.
FitResult FitOnce(std::span<const RecordView> records, Depth depth, FitOptions options) {
  loop::PreparedRecords prepared = loop::Prepare(records, options.preparation);
  std::shared_ptr<const loop::DrawnReadings>& drawn = options.preparation.drawn;
  if (!drawn) drawn = loop::DrawReadings(prepared);
  ScaledRecords data = Scale(prepared, options);
  if (!options.priors.empty()) {
    FitOptions open = options;
    open.priors.clear();
    const FitResult fit = Fitter(open).Fit(records, Depth::kEstimate);
    data.prior_noise =
        (data.is_forced() ? fit.records.front().displacement_noise : fit.force_noise) /
        data.response_unit();
  }
  RequireRecords(options, data);
  MeasureBesideKnownForces(options, data, prepared);
  RequireRigStifferThanLoop(options, prepared);

  const Attempt attempt{options, depth, prepared, data};
  SolvedFit solved = SolveFit(attempt);
  FitResult result = Assemble(attempt, solved);
  if (depth < Depth::kErrors || !std::isfinite(solved.solution().sum_of_squares)) return result;
  Infer(attempt, solved, result);
  if (depth < Depth::kFull) return result;
  result.law_choice = CompareLaws(records, options, data, result);
  // An inadequate model reports a choice against it only: the other law may be the reason.
  const bool is_inadequate = result.adequacy.verdict == AdequacyVerdict::kInadequate;
  if (is_inadequate && !result.prefers_other_law()) result.law_choice.reset();
  Append(result.findings, FindOtherLaw(result.law_choice));
  if (options.initial_state || result.adequacy.verdict == AdequacyVerdict::kAdequate ||
      result.prefers_other_law() || !options.preparation.held_out.empty()) {
    return result;
  }
  const std::vector<SampleRange> aside = FirstStrokesAside(data, result, options.thresholds);
  if (aside.empty()) return result;
  FitResult without = FitWithout(aside, records, std::move(options), depth);
  if (!without.converged || without.adequacy.tried == 0 ||
      without.adequacy.verdict != AdequacyVerdict::kAdequate) {
    return result;
  }
  for (const SampleRange& range : aside) without.records[range.record].first_stroke = range.end;
  return without;
}

/// True if the loop slides over most of its stroke, and so has carried its slip force, and a law
/// that misses more than poor_misfit carries that nowhere; unless the user limits Tc or the other
/// law is preferred.
bool RunsAway(const FitResult& result, const FitOptions& options) {
  const Thresholds& thresholds = options.thresholds;
  // Below Depth::kIntervals there is no misfit. The other law may carry the force.
  const bool is_followed = result.adequacy.verdict == AdequacyVerdict::kAdequate ||
                           result.adequacy.misfit <= thresholds.poor_misfit * result.MisfitScale();
  const bool is_limited =
      options.bounds.contains("slip_force") || options.fixed.contains("slip_force");
  return !is_followed && !is_limited && !result.prefers_other_law() &&
         !result.is_scaled_by_load() && result.response == loop::Channel::kForce &&
         loop::Slides(result.WidestRecord().facts) &&
         result.PeakForce() < thresholds.mobilised * result.law.slip_force;
}

/// Fits, and with a slip force no larger than the largest force where it runs away from that.
FitResult FitWithin(std::span<const RecordView> records, Depth depth, const FitOptions& options) {
  FitResult result = FitOnce(records, depth, options);
  if (RunsAway(result, options)) {
    FitOptions within = options;
    within.bounds["slip_force"] = {0.0, result.PeakForce()};
    within.start.clear();
    result = FitOnce(records, depth, std::move(within));
    // The largest force is known no better than the law follows it.
    if (IsFitted(result) && result.parameters[kSlipForce].upper95) {
      const double value = result.parameters[kSlipForce].value;
      Include(result.parameters[kSlipForce],
              {.lower = value, .upper = value + result.adequacy.misfit});
    }
  }
  // The discrepancy and other models may have extended an interval beyond the user's bounds.
  for (const auto& [name, bounds] : options.bounds) {
    const auto estimate = std::ranges::find(result.parameters, name, &ParameterEstimate::name);
    if (estimate == result.parameters.end()) continue;
    estimate->bounds = bounds;
    for (std::optional<double>* const end : {&estimate->lower95, &estimate->upper95}) {
      if (*end) *end = std::clamp(**end, bounds.lower, bounds.upper);
    }
  }
  return result;
}

}  // namespace

void Validate(const FitOptions& options) {
  if (options.model == nullptr) throw InvalidArgument("there is no model to be fitted");
  if (options.force_noise) RequirePositive("force_noise [N]", *options.force_noise);
  if (!(options.confidence > 0 && options.confidence < 1)) {
    ThrowInvalid("confidence [-]", options.confidence, "must be between 0 and 1, as 0.95");
  }
  loop::Validate(options.preparation);
  const loop::Channel response = options.response();
  for (const std::string& name : options.terms) {
    const Term* const term = FindTerm(name, response);
    using enum Presence;
    if (term == nullptr || term->of_column || term->presence == kAlways ||
        term->presence == kOffsets || term->presence == kLoadSeries) {
      throw InvalidArgument(fmt::format("'{}' is not a term that can be added", name));
    }
    RequirePlace(*term, response);
  }
  if (!options.covariates.empty()) RequirePlace(TermOf(TermId::kCovariate, response), response);
  if (response == loop::Channel::kDisplacement && options.force_noise) {
    throw InvalidArgument("noise of the force, which is imposed and taken as exact: leave it out");
  }
  if (options.response_noise())
    RequirePositive("displacement noise [m]", *options.response_noise());
  if (options.model->memory == models::Memory::kNone && HasTerm(options, TermId::kAsymmetry) &&
      HasTerm(options, TermId::kRigStiffness)) {
    throw InvalidArgument(
        fmt::format("asymmetry and rig_stiffness of {}: the rig deflects with the force, which is "
                    "not the state that the law integrates; leave one out, or use --model "
                    "mindlin-dahl, mindlin or jenkins",
                    options.model->name));
  }
  if (options.max_iterations < 1) {
    ThrowInvalid("maximum iterations [-]", options.max_iterations, "must be >= 1");
  }
}

Fitter::Fitter(FitOptions options) : options_(std::move(options)) { Validate(options_); }

const FitResult& Fitter::Fit(std::span<const RecordView> records, Depth depth) {
  return result_ = FitWithin(records, depth, options_);
}

const FitResult& Fitter::Continue(const RecordView& record, Depth depth) {
  const auto is_limited = [](const ParameterEstimate& estimate) {
    const bool is_fixed = estimate.status == ParameterStatus::kFixed;
    return estimate.is_at_bound() || (is_fixed && estimate.name == "alpha" && estimate.value == 0);
  };
  if (result_.converged && TellsTheLaw(result_) &&
      std::ranges::none_of(result_.parameters, is_limited)) {
    FitOptions continued = options_;
    StartFrom(result_, continued);
    const double as_good = options_.thresholds.larger_rms * result_.rms;
    result_ = FitWithin({&record, 1}, depth, continued);
    if (result_.converged && result_.rms <= as_good && TellsTheLaw(result_)) return result_;
  }
  return Fit(record, depth);
}

FitResult Fit(std::span<const loop::Record> records, const FitOptions& options, Depth depth) {
  const std::vector<RecordView> views(records.begin(), records.end());
  return Fitter(options).Fit(views, depth);
}

}  // namespace mindahl::identification
