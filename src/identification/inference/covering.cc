#include "identification/inference/covering.h"

#include <algorithm>
#include <optional>

#include "identification/inference/estimates.h"

namespace mindahl::identification {
namespace {

/// An end of an interval that another has farther out; open where that is.
template <typename Farther>
void Cover(std::optional<double>& end, const std::optional<double>& by, Farther farther) {
  if (!by) {
    end.reset();
  } else if (end) {
    end = farther(*end, *by);
  }
}

}  // namespace

std::vector<std::string> CoverRivalPast(const Problem& problem, const Problem& rival,
                                        const Solution& rival_solution, const Noise& noise,
                                        const Thresholds& thresholds, double peak_force,
                                        Response& response,
                                        std::span<ParameterEstimate> estimates) {
  const Estimates others(rival, rival_solution, noise, {}, thresholds, response);
  std::vector<std::string> apart;
  for (const std::size_t p : {kStiffness, kShape, kSlipForce}) {
    ParameterEstimate& estimate = estimates[p];
    if (rival.parameters[p].fixed) continue;
    ParameterEstimate other = estimate;
    other.value = rival.parameters[p].ToValue(rival_solution.theta[p]);
    others.Fill(p, other);
    // What is open either way is said already.
    const bool is_apart = estimate.lower95 && estimate.upper95 && other.lower95 && other.upper95 &&
                          (other.value < *estimate.lower95 || other.value > *estimate.upper95);
    if (is_apart) apart.push_back(estimate.name);
    if (other.lower95 && p == kSlipForce) other.lower95 = std::max(*other.lower95, peak_force);
    Cover(estimate.lower95, other.lower95, [](double a, double b) { return std::min(a, b); });
    Cover(estimate.upper95, other.upper95, [](double a, double b) { return std::max(a, b); });
  }
  response.Bind(problem);
  return apart;
}

void CoverPlateau(FitResult& result, const Thresholds& thresholds) {
  ParameterEstimate& slip_force = result.parameters[kSlipForce];
  const RecordFit& widest = result.WidestRecord();
  if (result.response == loop::Channel::kDisplacement) return;  // of a contact that never slips
  const bool slips = result.PeakForce() >= thresholds.mobilised_by_asymptote * slip_force.value;
  if (!widest.facts.half_gap || !slips || !slip_force.lower95 || !slip_force.upper95) return;
  const double half_gap = *widest.facts.half_gap / widest.load_ratio;
  slip_force.lower95 = std::min(*slip_force.lower95, half_gap);
  slip_force.upper95 = std::max(*slip_force.upper95, half_gap);
}

}  // namespace mindahl::identification
