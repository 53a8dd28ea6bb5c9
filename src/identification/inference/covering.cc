#include "identification/inference/covering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/probability.h"
#include "identification/inference/estimates.h"
#include "identification/intervals.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {

std::vector<std::string> CoverRival(const Problem& problem, const Rival& rival, const Noise& noise,
                                    const Thresholds& thresholds, double peak_force,
                                    Response& response, std::span<ParameterEstimate> estimates) {
  const Estimates others(rival.problem, rival.solution, noise, {}, thresholds, response);
  std::vector<std::string> apart;
  for (const std::size_t p : {kStiffness, kShape, kSlipForce}) {
    ParameterEstimate& estimate = estimates[p];
    const Parameter& parameter = rival.problem.parameters[p];
    if (parameter.fixed) continue;
    ParameterEstimate other = estimate;
    other.value = parameter.ToValue(rival.solution.theta[p]);
    others.Fill(p, other);
    // An end that is open in either fit is reported elsewhere.
    const bool is_apart = estimate.lower95 && estimate.upper95 && other.lower95 && other.upper95 &&
                          (other.value < *estimate.lower95 || other.value > *estimate.upper95);
    if (is_apart) apart.push_back(estimate.name);
    if (other.lower95 && p == kSlipForce) other.lower95 = std::max(*other.lower95, peak_force);
    Include(estimate, {.source = rival.source, .lower = other.lower95, .upper = other.upper95});
  }
  response.Bind(problem);
  return apart;
}

bool IsAnotherMinimum(const Problem& problem, const Solution& best, const Solution& other,
                      const Noise& noise, std::span<const ParameterEstimate> estimates) {
  const double quantile = NormalQuantile(noise.confidence);
  if (!other.converged || !std::isfinite(other.sum_of_squares)) return false;
  const double independent = noise.effective_samples() / static_cast<double>(noise.samples);
  const double ratio = independent * (other.sum_of_squares - best.sum_of_squares) / noise.variance;
  if (!(ratio < quantile * quantile)) return false;
  return std::ranges::any_of(std::array{kStiffness, kShape, kSlipForce}, [&](std::size_t p) {
    const ParameterEstimate& estimate = estimates[p];
    if (problem.parameters[p].fixed || !estimate.lower95 || !estimate.upper95) return false;
    const double value = problem.parameters[p].ToValue(other.theta[p]);
    return value < *estimate.lower95 || value > *estimate.upper95;
  });
}

ParameterEstimate CoverPlateau(const FitResult& result, const Thresholds& thresholds) {
  ParameterEstimate slip_force = result.parameters[kSlipForce];
  const RecordFit& widest = result.WidestRecord();
  if (result.response == loop::Channel::kDisplacement) return slip_force;  // never slips
  if (IsScaledByLoad(result)) return slip_force;
  const bool slips = result.PeakForce() >= thresholds.mobilised_by_asymptote * slip_force.value;
  if (!widest.facts.half_gap || !slips || !slip_force.lower95 || !slip_force.upper95)
    return slip_force;
  const double half_gap = *widest.facts.half_gap / widest.load_ratio;
  Include(slip_force, {.source = IntervalSource::kPlateau, .lower = half_gap, .upper = half_gap});
  return slip_force;
}

ParameterEstimate KeepAboveCarriedForce(const FitResult& result) {
  ParameterEstimate slip_force = result.parameters[kSlipForce];
  const RecordFit& widest = result.WidestRecord();
  if (result.response == loop::Channel::kDisplacement || !widest.facts.half_gap) return slip_force;
  if (IsScaledByLoad(result)) return slip_force;
  const bool has_other =
      std::ranges::any_of(result.parameters, [](const ParameterEstimate& estimate) {
        return estimate.name == "viscous" || estimate.name == "lag" ||
               estimate.name.starts_with(NameOfCovariate(""));
      });
  constexpr std::array<std::string_view, 5> kTurnWithMotion = {
      "viscous_force", "covariate", "guide_friction", "channel_lag", "normal_load"};
  const bool may_have_other = std::ranges::any_of(result.adequacy.causes, [&](const Cause& cause) {
    return std::ranges::find(kTurnWithMotion, cause.code) != kTurnWithMotion.end();
  });
  if (has_other || may_have_other || slip_force.includes_discrepancy) return slip_force;
  const double carried = *widest.facts.half_gap -
                         2 * widest.facts.half_gap_standard_deviation.value_or(0.0) -
                         result.ResponseNoise();
  if (!(carried > 0)) return slip_force;
  const double least = carried / widest.load_ratio;
  if (slip_force.value < least && !(slip_force.upper95 > least)) {
    WithdrawInterval(slip_force);
  } else {
    RaiseLowerEnd(slip_force, IntervalSource::kCarriedForce, std::min(least, slip_force.value));
  }
  return slip_force;
}

}  // namespace mindahl::identification
