#include "mindahl/identification/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identification/candidate.h"
#include "identification/estimator.h"
#include "identification/scaled_records.h"
#include "identification/slip_force_profile.h"
#include "identification/turning_points.h"
#include "identification/verdicts.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"

namespace mindahl {
namespace {

void RequireOptions(std::span<const Record> records, const FitOptions& options) {
  if (records.empty()) throw InvalidArgument("there is no record: a fit needs at least one");
  if (options.model == nullptr || options.model->scaled_by_peak) {
    throw InvalidArgument("the model cannot be fitted: it must be told the amplitude");
  }
  if (options.force_sense && *options.force_sense != 1 && *options.force_sense != -1) {
    ThrowInvalid("force sense [-]", *options.force_sense, "must be +1 or -1");
  }
  if (options.force_noise) RequirePositive("force noise [N]", *options.force_noise);
  if (options.reversal_gate) RequireNonNegative("reversal gate [m]", *options.reversal_gate);
  if (options.max_iterations < 1) {
    ThrowInvalid("maximum iterations [-]", options.max_iterations, "must be >= 1");
  }
  if (options.starts < 1) ThrowInvalid("starts [-]", 0, "must be >= 1");
  for (const Record& record : records) Validate(record);
}

void FillRecords(FitResult& result, std::span<const Record> records, const ScaledRecords& data,
                 std::span<const double> scaled_residual) {
  const std::vector<std::vector<double>> parts = SplitByRecord(data, scaled_residual);
  for (std::size_t r = 0; r < records.size(); ++r) {
    RecordFit& fit = result.records[r];
    for (std::size_t i = 0; i < parts[r].size(); ++i) {
      fit.residual.push_back(data.sense * data.force * parts[r][i]);
      fit.fitted_force.push_back(records[r].force[i] + fit.residual.back());
    }
  }
}

/// Reversals and the force's sense: what depends on no model.
int PrepareRecords(std::span<const Record> records, const FitOptions& options, FitResult& result) {
  int votes = 0;
  for (const Record& record : records) {
    RecordFit& fit = result.records.emplace_back();
    fit.reversal_gate = options.reversal_gate.value_or(EstimateReversalGate(record.displacement));
    fit.reversals = FindReversals(record.displacement, fit.reversal_gate);
    votes += ForceSense(record, fit.reversals);
  }
  const int sense = options.force_sense.value_or(votes < 0 ? -1 : 1);
  for (std::size_t r = 0; r < records.size(); ++r) {
    Record oriented = records[r];
    for (double& force : oriented.force) force *= sense;
    result.records[r].measures = MeasureLoop(oriented, result.records[r].reversals);
  }
  return sense;
}

/// Frees the turning points where the record was sampled too coarsely to show them.
void RefineTurningPoints(Candidate& best, const ScaledRecords& data, const FitOptions& options,
                         FitResult& result) {
  if (!best.solution.converged) return;
  // A gate means noise in the displacement: its outermost samples are the noisiest, and say nothing
  // of where the motion turned.
  if (std::ranges::any_of(result.records,
                          [](const RecordFit& fit) { return fit.reversal_gate > 0; })) {
    return;
  }
  // Residuals of rounding size have nothing left to explain.
  const double rms = std::sqrt(best.solution.sum_of_squares / static_cast<double>(data.samples()));
  if (rms < kRoundingRms) return;
  std::optional<TurningPointFit> refined =
      FitTurningPoints(data, best.residual, best.layout, best.solution, options);
  if (!refined) return;
  best.layout = std::move(refined->layout);
  best.solution = std::move(refined->solution);
  std::size_t position = best.layout.reported();
  double largest = 0.0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    for (std::size_t j = 0; j < data.records[r].reversals.size(); ++j, ++position) {
      const double overshoot =
          best.layout.parameters()[position].ToValue(best.solution.theta[position]);
      result.records[r].overshoot.push_back(overshoot);
      largest = std::max(largest, overshoot);
    }
  }
  Warn(result, "turning_points_between_samples",
       fmt::format("the motion turns between samples, up to {:.3g} m beyond the outermost: the "
                   "turning points were fitted too; sample more densely",
                   largest));
}

std::vector<std::vector<std::size_t>> ReversalsOf(const FitResult& result) {
  std::vector<std::vector<std::size_t>> reversals;
  for (const RecordFit& fit : result.records) reversals.push_back(fit.reversals);
  return reversals;
}

}  // namespace

const ParameterEstimate* FitResult::Find(std::string_view name) const {
  const auto found = std::ranges::find(parameters, name, &ParameterEstimate::name);
  return found == parameters.end() ? nullptr : &*found;
}

const RecordFit& FitResult::WidestRecord() const {
  return *std::ranges::max_element(records, {},
                                   [](const RecordFit& fit) { return fit.measures.amplitude; });
}

FitResult Fit(std::span<const Record> records, const FitOptions& options) {
  RequireOptions(records, options);
  FitResult result;
  result.model = options.model;
  result.force_sense = PrepareRecords(records, options, result);
  const ScaledRecords data = Scale(records, ReversalsOf(result), result.force_sense);

  Candidate best = FitBestState(data, options);
  RefineTurningPoints(best, data, options, result);
  result.initial_state = best.state;
  result.starts = best.starts;
  result.termination = best.solution.termination;
  result.iterations = best.solution.iterations;
  result.converged = best.solution.converged;
  if (!std::isfinite(best.solution.sum_of_squares)) {
    result.converged = false;
    return result;
  }
  result.law = best.layout.Law(best.solution.theta);

  std::vector<double> residual(best.residual.size());
  best.residual.Evaluate(best.solution.theta, residual);
  FillRecords(result, records, data, residual);
  std::vector<std::vector<double>> residuals;
  std::vector<std::vector<double>> forces;
  for (std::size_t r = 0; r < records.size(); ++r) {
    residuals.push_back(result.records[r].residual);
    forces.push_back(records[r].force);
  }
  result.residuals =
      DescribeResiduals(residuals, forces, result.law.slip_force, best.layout.free().size());

  const auto samples = static_cast<double>(data.samples());
  const auto free_parameters = static_cast<double>(best.layout.free().size());
  const double noise = options.force_noise.value_or(0.0) / data.force;
  const double variance = std::max(
      options.force_noise ? noise * noise
                          : best.solution.sum_of_squares / std::max(samples - free_parameters, 1.0),
      kRoundingRms * kRoundingRms);
  const Estimator estimator(best, variance, result.residuals);
  const std::size_t count = best.layout.reported();
  for (std::size_t i = 0; i < count; ++i) {
    result.parameters.push_back(estimator.Estimate(i));
    for (std::size_t j = 0; j < count; ++j) {
      result.correlation.push_back(estimator.Correlation(i, j));
    }
  }
  JudgeNullDirections(result, best, estimator.local());
  const double share = result.residuals.effective_samples / samples;
  const double critical = estimator.quantile() * estimator.quantile();  // of F(1, ν), χ²₁ as ν → ∞
  JudgeProfile(result, best.layout,
               ProfileSlipForce(best.residual, best.layout, best.solution, variance, share,
                                critical, options),
               estimator.quantile());
  JudgeStiffness(result, StiffnessIsOpenAbove(best.residual, best.layout, best.solution, variance,
                                              share, critical, options));
  JudgeIntervals(result);
  return result;
}

}  // namespace mindahl
