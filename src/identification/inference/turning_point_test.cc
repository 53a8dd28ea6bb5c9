#include "identification/inference/turning_point_test.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/inference/local.h"
#include "identification/inference/noise.h"
#include "identification/solve/search.h"

namespace mindahl::identification {
namespace {

/// Returns the largest of all records' reversals.
double LargestOf(double (*overshoot)(const ScaledRecord&, std::size_t), const ScaledRecords& data) {
  double largest = 0.0;
  for (const ScaledRecord& record : data.records) {
    for (std::size_t k = 0; k < record.reversals.size(); ++k) {
      largest = std::max(largest, overshoot(record, k));
    }
  }
  return largest;
}

/// The most that turning points where the motion has them move a parameter, in standard errors: as
/// if every sample lay on the steepest part of its branch.
double LargestShift(const Problem& problem, const Solution& best) {
  const auto counted = static_cast<double>(problem.data->counted);
  return counted * std::exp(best.theta[kStiffness]) * LargestOf(OvershootOfMotion, *problem.data) /
         std::sqrt(best.sum_of_squares);
}

/// Returns the fit with turning points where the motion has them; empty where that hardly matters,
/// or the record shows its outermost samples to be better.
std::optional<TurningPointFit> FitTurnedAsTheMotion(const Problem& problem, const Solution& best,
                                                    const FitOptions& options,
                                                    SearchBuffers& buffers) {
  if (!(LargestShift(problem, best) > options.thresholds.turning_point_shift)) return {};
  std::vector<double> overshoot;
  for (const ScaledRecord& record : problem.data->records) {
    for (std::size_t k = 0; k < record.reversals.size(); ++k) {
      overshoot.push_back(OvershootOfMotion(record, k));
    }
  }
  TurningPointFit fit{PutInTurningPoints(*problem.data, overshoot), best};
  Problem turned = problem;
  turned.data = &fit.records->data;
  buffers.solver.Bind(turned, buffers.response);
  buffers.solver.Solve(best.theta, SolverOptionsOf(options), fit.solution);
  if (!fit.solution.converged) return {};
  if (fit.solution.sum_of_squares <= best.sum_of_squares) return fit;
  // If both are nearly as likely, the fit that does not take a sample for a turn is chosen.
  std::vector<double> residual(problem.size());
  EvaluateResidual(problem, best.theta, buffers.response, residual);
  const Evidence evidence(problem.data->counted, EffectiveSamples(*problem.data, residual));
  const double loss = evidence.LikelihoodRatio(fit.solution.sum_of_squares, best.sum_of_squares);
  if (loss > options.thresholds.indistinguishable) return {};
  return fit;
}

}  // namespace

std::optional<TurningPointFit> FitTurningPointsIfNeeded(const Problem& problem,
                                                        const Solution& best,
                                                        const FitOptions& options,
                                                        SearchBuffers& buffers) {
  const ScaledRecords& data = *problem.data;
  std::size_t reversals = 0;
  for (const ScaledRecord& record : data.records) reversals += record.reversals.size();
  if (reversals == 0) return {};
  const auto count = static_cast<double>(data.counted);
  // Residuals of rounding size have nothing left to explain.
  const auto is_rounding = [&](const Solution& solution) {
    return std::sqrt(solution.sum_of_squares / count) < kRoundingRms;
  };
  if (is_rounding(best)) return {};
  std::optional<TurningPointFit> of_motion = FitTurnedAsTheMotion(problem, best, options, buffers);
  const Solution& start = of_motion ? of_motion->solution : best;
  const double least = start.sum_of_squares;
  if (is_rounding(start)) return of_motion;

  const std::size_t parameters = problem.parameters.free().size() + reversals;
  if (2 * parameters > data.counted) return of_motion;
  // Missed extremes explain nothing that no sample could show: σ·overshoot is the most they may do.
  const double most = std::exp(best.theta[kStiffness]) * LargestOf(LongestOvershoot, data);
  if (count * count * most * most / least < 2 * static_cast<double>(reversals)) return of_motion;

  const double needed =
      ChiSquaredQuantile(static_cast<double>(reversals), options.thresholds.turning_point_chance);
  const std::vector<double> overshoot =
      of_motion ? of_motion->records->overshoot : std::vector<double>(reversals, 0.0);
  TurningPointStep step = StepTurningPoints(problem, start, overshoot, buffers.response);
  const std::unique_ptr<TurnedRecords> turned = PutInTurningPoints(data, step.overshoot);
  const double left = EffectiveSamples(turned->data, {step.left.data(), turned->data.samples()});
  if (!(Evidence(data.counted, left).LikelihoodRatio(least, step.left.squaredNorm()) > needed)) {
    return of_motion;
  }
  TurningPointFit fit = FitTurningPoints(problem, start, std::move(step.overshoot),
                                         SolverOptionsOf(options), buffers.response);
  Problem refitted = problem;
  refitted.data = &fit.records->data;
  std::vector<double> residual(refitted.size());
  EvaluateResidual(refitted, fit.solution.theta, buffers.response, residual);
  const Evidence evidence(data.counted, EffectiveSamples(*refitted.data, residual));
  const double price = 2 * static_cast<double>(reversals);
  const double gain = evidence.LikelihoodRatio(least, fit.solution.sum_of_squares);
  if (!fit.solution.converged || !(gain > std::max(price, needed))) return of_motion;
  return fit;
}

}  // namespace mindahl::identification
