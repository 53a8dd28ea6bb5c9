#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/probability.h"
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

namespace mindahl::identification {
namespace {

/// True if the residuals are rounding errors: they are no noise, are autocorrelated as they like,
/// and nothing is to be learnt from what they look like.
bool LeavesOnlyRounding(const Problem& problem, const Solution& solution) {
  const auto count = static_cast<double>(problem.data->counted);
  return std::sqrt(solution.sum_of_squares / count) < kOnlyRounding;
}

/// Estimates the noise and the statistics of the residuals.
/// @param residual  weighted, of every sample
void MeasureNoise(const Attempt& attempt, const Problem& problem, const Solution& solution,
                  std::span<const double> residual, Noise& noise, FitResult& result) {
  if (!LeavesOnlyRounding(problem, solution)) {
    noise.autocorrelation = EstimateAutocorrelation(problem.data->records, residual);
    const bool any_differs = problem.data->records.size() > 1 && !noise.is_known;
    if (any_differs) noise.of_records = VariancesOfRecords(*problem.data, residual);
  }
  double widening = 1.0;
  for (std::size_t r = 0; r < result.records.size(); ++r) {
    const ScaledRecord& record = problem.data->records[r];
    ResidualStructure& structure = result.records[r].structure;
    structure = DescribeStructure(record, record.Of(residual), attempt.options.thresholds);
    widening = std::max(widening, structure.Widening());
  }
  if (!LeavesOnlyRounding(problem, solution)) noise.repeating = widening;
  result.residuals = DescribeResiduals(result.records);
  result.residuals.effective_samples = noise.effective_samples();
  result.degrees_of_freedom = noise.degrees_of_freedom(problem.parameters.free().size());
}

/// Adequacy, and intervals that cover what its causes would change.
/// @param is_limited  did the search end at a limit of its own?
void ConsiderDepartures(const Estimates& fitted, bool is_limited, const FitOptions& options,
                        FitResult& result) {
  const Problem& problem = fitted.problem();
  const Solution& solution = fitted.solution();
  const Thresholds& thresholds = options.thresholds;
  if (LeavesOnlyRounding(problem, solution)) {
    result.adequacy.tried = 1;
    GradeUse(thresholds, result);
    return;
  }
  AdequacyTest test = TestAdequacy(fitted, thresholds);
  const std::vector<OmittedTerm> causes = CausesOf(test, thresholds);
  result.adequacy = JudgeAdequacy(*problem.data, test, causes, is_limited, result, thresholds);
  GradeUse(thresholds, result);
  if (!MayOmitTerms(result.adequacy, thresholds)) return;
  WidenByOmittedTerms(problem, solution, test, causes,
                      StudentQuantile(test.degrees_of_freedom, options.confidence),
                      result.parameters);
  if (result.adequacy.verdict == AdequacyVerdict::kAdequate) return;
  result.parameters = CoverDiscrepancy(fitted, thresholds, result);
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
  Append(result.findings, FindUndetermined(estimates));
}

}  // namespace

FitResult Infer(const Attempt& attempt, SolvedFit solved, FitResult result) {
  const FitOptions& options = attempt.options;
  const Problem& problem = solved.best.problem;
  const Solution& solution = solved.solution();
  Noise& noise = solved.noise;
  const Thresholds& thresholds = options.thresholds;
  const bool is_judged = result.depth >= Depth::kIntervals;
  const bool is_tested = result.depth >= Depth::kFull;
  Linearization at = LinearizeAt(problem, solution.theta, problem.parameters.free());
  MeasureNoise(attempt, problem, solution, {at.residual.data(), problem.size()}, noise, result);
  const Estimates fitted(problem, solution, noise, options, std::move(at));
  FillErrors(problem, fitted, result);
  result.parameters = WithProfiles(fitted, result, options);
  if (is_tested) {
    Append(result.findings, IncludeCompliantRig(fitted, options, result.parameters));
  }
  if (solved.of_other_state) IncludeLaw(*solved.of_other_state, result.parameters);
  if (!problem.data->is_forced()) CoverSteps(attempt.prepared, result);
  const std::optional<Finding> limit = FindSearchLimit(problem, solution);
  Append(result.findings, limit);
  if (is_judged) {
    ConsiderDepartures(fitted, limit.has_value(), options, result);
  }
  result.parameters[kSlipForce] = KeepAboveCarriedForce(problem.parameters, result);
  Append(result.findings, FindOnParameters(fitted, attempt.prepared, options, result));
  WithdrawIfInadequate(thresholds, result);
  Append(result.findings, FindWideIntervals(result, thresholds));
  Judge(result.parameters, result.findings);
  return result;
}

}  // namespace mindahl::identification
