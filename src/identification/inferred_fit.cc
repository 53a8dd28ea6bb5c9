#include <algorithm>
#include <cmath>
#include <cstddef>
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

FitResult Infer(const Attempt& attempt, SolvedFit solved, FitResult result) {
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
  return result;
}

}  // namespace mindahl::identification
