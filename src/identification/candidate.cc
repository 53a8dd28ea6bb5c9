#include "identification/candidate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "identification/starting_values.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {

using models::InitialState;

namespace {

double Rms(double sum_of_squares, const ScaledRecords& data) {
  return data.force * std::sqrt(sum_of_squares / static_cast<double>(data.weighted_samples()));
}

/// Where α is held the likelihood may have kinks (a Jenkins loop just past slip has a false minimum
/// where none of its samples slips); with α free it is smooth, and its minimum is a start.
std::optional<StartingPoint> StartWithFreeShape(InitialState state, const ScaledRecords& data,
                                                const FitOptions& options,
                                                const ParameterLayout& held) {
  models::FrictionModel model = *options.model;
  model.shape_exponent.reset();
  FitOptions relaxed = options;
  relaxed.model = &model;
  relaxed.fixed.erase("alpha");
  relaxed.starts = 1;
  const ParameterLayout layout(data, relaxed, state);
  const ForceResidual residual(data, model, state, layout);
  const std::vector<StartingPoint> starts = FindStartingPoints(data, layout, relaxed, state);
  if (starts.empty()) return {};
  Solution solution = Solve(residual, layout, starts.front().theta, relaxed);
  solution.theta[kShapeExponent] = held.parameters()[kShapeExponent].theta;
  return StartingPoint{.theta = solution.theta,
                       .sum_of_squares = residual.SumOfSquares(solution.theta)};
}

Candidate FitFrom(InitialState state, const ScaledRecords& data, const FitOptions& options) {
  const ParameterLayout layout(data, options, state);
  Candidate candidate{.state = state,
                      .layout = layout,
                      .residual = ForceResidual(data, *options.model, state, layout),
                      .solution = {},
                      .starts = {}};
  if (data.weighted_samples() < candidate.layout.free().size()) {
    throw InvalidArgument(
        fmt::format("{} samples are too few for {} free parameters: record more or fix some",
                    data.weighted_samples(), candidate.layout.free().size()));
  }
  candidate.solution.sum_of_squares = std::numeric_limits<double>::infinity();
  candidate.solution.termination = "no starting point has the force's sense";
  std::vector<StartingPoint> starts = FindStartingPoints(data, candidate.layout, options, state);
  if (!starts.empty() && candidate.layout.parameters()[kShapeExponent].fixed) {
    const auto relaxed = StartWithFreeShape(state, data, options, candidate.layout);
    if (relaxed) starts.push_back(*relaxed);
  }
  for (const StartingPoint& start : starts) {
    Solution solution = Solve(candidate.residual, candidate.layout, start.theta, options);
    candidate.starts.push_back({.drawn = start.drawn,
                                .start = candidate.layout.Law(start.theta),
                                .initial_rms = Rms(start.sum_of_squares, data),
                                .reached = candidate.layout.Law(solution.theta),
                                .final_rms = Rms(solution.sum_of_squares, data),
                                .converged = solution.converged});
    if (solution.sum_of_squares < candidate.solution.sum_of_squares) {
      candidate.solution = std::move(solution);
    }
  }
  return candidate;
}

std::vector<std::vector<double>> ScaledForces(const ScaledRecords& data) {
  std::vector<std::vector<double>> forces;
  for (const ScaledRecord& record : data.records) forces.push_back(record.force);
  return forces;
}

ResidualStatistics DescribeScaled(const ScaledRecords& data, const Candidate& candidate) {
  std::vector<double> values(candidate.residual.size());
  candidate.residual.Evaluate(candidate.solution.theta, values);
  return DescribeResiduals(SplitByRecord(data, values), ScaledForces(data), 1.0,
                           candidate.layout.free().size());
}

/// Akaike's criterion with its small-sample term, for Gaussian residuals of unknown variance. The
/// effective samples weigh the likelihood only: a wrong law leaves a handful of them, for which the
/// small-sample term would outweigh any difference between two fits.
double CorrectedAkaike(const Candidate& candidate, double samples, const ScaledRecords& data) {
  const double mean_square =
      std::max(candidate.solution.sum_of_squares / static_cast<double>(data.weighted_samples()),
               kRoundingRms * kRoundingRms);
  const auto parameters = static_cast<double>(candidate.layout.free().size() + 1);
  return samples * std::log(mean_square) + 2 * parameters +
         2 * parameters * (parameters + 1) /
             std::max(static_cast<double>(data.weighted_samples()) - parameters - 1, 1.0);
}

}  // namespace

Candidate FitBestState(const ScaledRecords& data, const FitOptions& options) {
  if (options.initial_state) return FitFrom(*options.initial_state, data, options);
  const bool unloaded_is_given = std::ranges::any_of(options.fixed, [](const auto& fixed) {
    return fixed.first.starts_with("displacement_offset");
  });
  if (unloaded_is_given) return FitFrom(InitialState::kVirgin, data, options);
  Candidate virgin = FitFrom(InitialState::kVirgin, data, options);
  const bool any_reversal = std::ranges::any_of(
      data.records, [](const ScaledRecord& record) { return !record.reversals.empty(); });
  if (!any_reversal) return virgin;
  Candidate steady = FitFrom(InitialState::kSteady, data, options);
  const Candidate& better =
      virgin.solution.sum_of_squares < steady.solution.sum_of_squares ? virgin : steady;
  if (!std::isfinite(better.solution.sum_of_squares)) return virgin;  // neither was even started
  const double samples = DescribeScaled(data, better).effective_samples;
  return CorrectedAkaike(virgin, samples, data) < CorrectedAkaike(steady, samples, data)
             ? std::move(virgin)
             : std::move(steady);
}

}  // namespace mindahl::identification
