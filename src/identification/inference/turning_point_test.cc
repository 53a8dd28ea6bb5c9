#include "identification/inference/turning_point_test.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "identification/inference/local.h"
#include "identification/inference/noise.h"
#include "identification/solve/search.h"

namespace mindahl::identification {
namespace {

/// The most that turning points where the motion has them move a parameter, in standard errors: as
/// if every sample lay on the steepest part of its branch.
double LargestShift(const Problem& problem, const Solution& best) {
  double largest = 0.0;
  for (const ScaledRecord& record : problem.data->records) {
    for (std::size_t k = 0; k < record.reversals.size(); ++k) {
      largest = std::max(largest, OvershootOfMotion(record, k));
    }
  }
  return static_cast<double>(problem.data->counted) * std::exp(best.theta[kStiffness]) * largest /
         std::sqrt(best.sum_of_squares);
}

}  // namespace

std::optional<TurningPointFit> FitAtTurningPoints(const Problem& problem, const Solution& best,
                                                  const FitOptions& options,
                                                  SearchBuffers& buffers) {
  // Residuals of rounding size have nothing left to explain.
  const double rms = std::sqrt(best.sum_of_squares / static_cast<double>(problem.data->counted));
  if (rms < kRoundingRms) return {};
  if (!(LargestShift(problem, best) > options.thresholds.turning_point_shift)) return {};
  std::vector<double> overshoot;
  for (const ScaledRecord& record : problem.data->records) {
    for (std::size_t k = 0; k < record.reversals.size(); ++k) {
      overshoot.push_back(OvershootOfMotion(record, k));
    }
  }
  TurningPointFit fit{std::make_unique<ScaledRecords>(PutInTurningPoints(*problem.data, overshoot)),
                      best};
  Problem turned = problem;
  turned.data = fit.records.get();
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

}  // namespace mindahl::identification
