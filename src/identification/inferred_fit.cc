#include "identification/inferred_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/diagnosis.h"
#include "identification/diagnosis/discrepancy.h"
#include "identification/diagnosis/grade.h"
#include "identification/diagnosis/record_findings.h"
#include "identification/diagnosis/residual_structure.h"
#include "identification/gram/omitted_terms.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/inference/profile.h"
#include "identification/inference/reweighting.h"
#include "identification/inference/rig_alternative.h"
#include "identification/intervals.h"
#include "identification/judge/judge.h"
#include "identification/problem/problem.h"
#include "identification/problem/scaled_records.h"
#include "identification/solve/search.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {
namespace {

using loop::RecordView;

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

/// True if the residuals are rounding errors: they are no noise, are autocorrelated as they like,
/// and nothing is to be learnt from what they look like.
bool LeavesOnlyRounding(const Problem& problem, const Solution& solution) {
  const auto counted = static_cast<double>(problem.data->counted);
  return std::sqrt(solution.sum_of_squares / counted) < kOnlyRounding;
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

/// Adequacy, and intervals that cover what its causes would change.
/// @param is_limited  did the search end at a limit of its own?
void ConsiderDepartures(const FittedProblem& fitted, const DisplacementEffect& displacement,
                        bool is_limited, const FitOptions& options, SearchBuffers& buffers,
                        FitResult& result) {
  const auto& [problem, solution, noise, estimates] = fitted;
  const Thresholds& thresholds = options.thresholds;
  if (LeavesOnlyRounding(problem, solution)) {
    result.adequacy.tried = 1;
    result.adequacy = GradeUse(thresholds, result);
    return;
  }
  AdequacyTest test = TestAdequacy(fitted, displacement, thresholds, buffers.response);
  const std::vector<DepartureFit> causes = CausesOf(test, thresholds);
  result.adequacy = JudgeAdequacy(*problem.data, test, causes);
  const bool is_doubtful =
      IsDoubtful(test, thresholds) || is_limited || RemembersTooLong(result, thresholds);
  result.adequacy.verdict = is_doubtful ? AdequacyVerdict::kDoubtful : AdequacyVerdict::kAdequate;
  result.adequacy = DoubtedByNoise(thresholds, result);
  result.adequacy = GradeUse(thresholds, result);
  result.parameters = WithRepeatErrors(fitted, thresholds, result);
  if (result.adequacy.verdict == AdequacyVerdict::kAdequate) return;
  WidenByOmittedTerms(problem, solution, test, causes,
                      StudentQuantile(test.degrees_of_freedom, options.confidence),
                      result.parameters);
  result.parameters = CoverDiscrepancy(fitted, thresholds, result);
}

/// Estimates the noise and the statistics of the residuals.
/// @param residual  weighted, of every sample
void MeasureNoise(const Attempt& attempt, const Problem& problem, const Solution& solution,
                  std::span<const double> residual, Noise& noise, FitResult& result) {
  const FitOptions& options = attempt.options;
  const bool only_rounding = LeavesOnlyRounding(problem, solution);
  if (!only_rounding) {
    noise.autocorrelation = AutocorrelationOf(*problem.data, residual);
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

/// Replaces the intervals by those of the likelihood where the parabola may fail.
void UseProfiles(const FittedProblem& fitted, const FitOptions& options, SearchBuffers& buffers,
                 FitResult& result) {
  const bool slips =
      result.PeakForce() >= options.thresholds.parabola_mobilised * result.law.slip_force;
  const bool knows_slip = fitted.problem.parameters[kSlipForce].fixed;
  // A fit that leaves only rounding errors ends at a reversal, where the derivatives jump and the
  // parabola is wrong.
  const bool only_rounding = LeavesOnlyRounding(fitted.problem, fitted.solution);
  std::vector<std::size_t> profiled;
  if ((!slips && !knows_slip) || NeedsProfile(fitted, kSlipForce, options, buffers) ||
      NeedsProfile(fitted, kRig, options, buffers)) {
    profiled = {kStiffness, kShape, kSlipForce, kRig};
  } else if (IsBadlyKnown(fitted, kStiffness, options.thresholds) || only_rounding) {
    profiled = {kStiffness};
  }
  result.parameters =
      WithProfiles(fitted, profiled, options, buffers, std::move(result.parameters));
}

/// Includes Mindlin's contact in a compliant rig, where the record does not distinguish it.
void ConsiderRig(const Attempt& attempt, const FittedProblem& fitted, FitResult& result) {
  const auto rig =
      TryRig(fitted, attempt.thin, result.parameters[kShape], attempt.options, attempt.buffers);
  if (!rig) return;
  result.parameters = IncludeRig(*rig, attempt.options.thresholds, std::move(result.parameters));
  result.findings.push_back(
      {.code = "shape_or_rig",
       .numbers = {{"rig_stiffness", rig->rig_stiffness}, {"alpha", result.law.shape_exponent}}});
}

}  // namespace

FitResult Infer(const Attempt& attempt, SolvedFit solved, FitResult result) {
  const FitOptions& options = attempt.options;
  const Problem& problem = solved.best.problem;
  const Solution& solution = solved.solution();
  Noise& noise = solved.noise;
  const Thresholds& thresholds = options.thresholds;
  SearchBuffers& buffers = attempt.buffers;
  const bool is_judged = result.depth >= Depth::kIntervals;
  const bool is_tested = result.depth >= Depth::kFull;
  MeasureNoise(attempt, problem, solution, {solved.at.residual.data(), problem.size()}, noise,
               result);
  const DisplacementEffect displacement =
      EffectOf(solved.displacement_errors, problem, solution, noise);
  const Estimates estimates(problem, solution, noise, displacement, thresholds,
                            std::move(solved.at));
  const FittedProblem fitted{problem, solution, noise, estimates};
  FillErrors(problem, estimates, result);
  UseProfiles(fitted, options, buffers, result);
  if (is_tested) ConsiderRig(attempt, fitted, result);
  const std::optional<Finding> limit = FindSearchLimit(problem, solution);
  Append(result.findings, limit);
  if (is_judged) {
    ConsiderDepartures(fitted, displacement, limit.has_value(), options, buffers, result);
  }
  result.parameters[kStiffness] = CoverSlipFactor(
      problem, solution, std::move(result.parameters[kStiffness]), buffers.response);
  result.parameters[kSlipForce] = KeepAboveCarriedForce(problem, result);
  Append(result.findings, FindUnseenLoop(result, thresholds));
  if (is_judged) {
    if (!options.initial_state && options.initial_states.empty()) {
      Append(result.findings, FindUnknownPast(problem, solution, thresholds));
    }
    Append(result.findings, FindFewPlaces(problem, thresholds));
  }
  Append(result.findings, FindUntoldAsymmetry(result, thresholds));
  if (is_judged) Append(result.findings, FindShapeLimitedByLoad(problem, solution));
  Append(result.findings, FindContradictedPrior(result, thresholds));
  Append(result.findings, FindOpenSlipForce(result));
  Append(result.findings, FindWideIntervals(result, thresholds));
  if (is_judged && IsInadequate(result, thresholds)) {
    result = WithoutInadequate(std::move(result));
  }
  Judge(result.parameters, result.findings);
  return result;
}

}  // namespace mindahl::identification
