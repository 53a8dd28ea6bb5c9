#include "identification/inference/turning_point_test.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "identification/inference/evidence.h"
#include "identification/inference/local.h"
#include "identification/solve/search.h"

namespace mindahl::identification {
namespace {

/// Effective samples of residuals, weighted or not, one record after the other.
double EffectiveSamples(const ScaledRecords& data, std::span<const double> residual) {
  return static_cast<double>(data.counted) /
         AutocorrelationOf(data, residual).SquaredCorrelations();
}

/// How far the motion may turn beyond any sample; as LongestOvershoots, the longest of them.
double LongestOvershoot(const ScaledRecords& data) {
  double longest = 0.0;
  for (const ScaledRecord& record : data.records) {
    const auto& x = record.displacement;
    for (const std::size_t i : record.reversals) {
      longest = std::max({longest, std::abs(x[i] - x[i - 1]), std::abs(x[i + 1] - x[i])});
    }
  }
  return longest;
}

}  // namespace

std::optional<TurningPointFit> FitTurningPointsIfNeeded(const Problem& problem,
                                                        const Solution& best,
                                                        const FitOptions& options,
                                                        Response& response) {
  const ScaledRecords& data = *problem.data;
  std::size_t reversals = 0;
  for (const ScaledRecord& record : data.records) reversals += record.reversals.size();
  const std::size_t parameters = problem.parameters.free().size() + reversals;
  if (reversals == 0 || 2 * parameters > data.counted) return {};
  const auto count = static_cast<double>(data.counted);
  // Residuals of rounding size have nothing left to explain.
  const double variance = best.sum_of_squares / count;
  if (std::sqrt(variance) < kRoundingRms) return {};
  // Nor have missed extremes that no sample could show: σ·overshoot is the most they may do.
  const double most = std::exp(best.theta[kStiffness]) * LongestOvershoot(data);
  if (count * most * most / variance < 2 * static_cast<double>(reversals)) return {};

  const double needed =
      ChiSquaredQuantile(static_cast<double>(reversals), options.thresholds.turning_point_chance);
  TurningPointStep step = StepTurningPoints(problem, best, response);
  const std::unique_ptr<TurnedRecords> turned = PutInTurningPoints(data, step.overshoot);
  const double left = EffectiveSamples(turned->data, {step.left.data(), turned->data.samples()});
  if (!(Evidence(data.counted, left).LikelihoodRatio(best.sum_of_squares, step.left.squaredNorm()) >
        needed)) {
    return {};
  }
  TurningPointFit fit = FitTurningPoints(problem, best, std::move(step.overshoot),
                                         SolverOptionsOf(options), response);
  Problem refitted = problem;
  refitted.data = &fit.records->data;
  std::vector<double> residual(refitted.size());
  EvaluateResidual(refitted, fit.solution.theta, response, residual);
  const Evidence evidence(data.counted, EffectiveSamples(*refitted.data, residual));
  const double price = 2 * static_cast<double>(reversals);
  const double gain = evidence.LikelihoodRatio(best.sum_of_squares, fit.solution.sum_of_squares);
  if (!fit.solution.converged || !(gain > std::max(price, needed))) return {};
  return fit;
}

}  // namespace mindahl::identification
