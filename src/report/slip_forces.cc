#include "mindahl/report/slip_forces.h"

#include <algorithm>
#include <cmath>

#include "mindahl/report/contact.h"

namespace mindahl::report {

using identification::FitResult;
using identification::ParameterEstimate;
using identification::ParameterStatus;

namespace {

/// Ways of ln Tc and of a, the latter in proportion to the slip force, as one of their sum.
std::optional<double> Together(const std::optional<double>& of_slip_force,
                               const std::optional<double>& of_asymmetry, double correlation) {
  if (!of_slip_force || !of_asymmetry) return std::nullopt;
  return std::sqrt(std::max(*of_slip_force * *of_slip_force + *of_asymmetry * *of_asymmetry +
                                2 * correlation * *of_slip_force * *of_asymmetry,
                            0.0));
}

/// 0 of what is held.
std::optional<double> WayTo(const ParameterEstimate& estimate, const std::optional<double>& end) {
  if (estimate.status == ParameterStatus::kFixed) return 0.0;
  if (!end) return std::nullopt;
  return std::abs(*end - estimate.value);
}

std::optional<double> LogWayTo(const ParameterEstimate& estimate,
                               const std::optional<double>& end) {
  if (estimate.status == ParameterStatus::kFixed) return 0.0;
  if (!end || !(*end > 0)) return std::nullopt;
  return std::abs(std::log(*end / estimate.value));
}

std::optional<double> ErrorOf(const ParameterEstimate& estimate) {
  return estimate.status == ParameterStatus::kFixed ? std::optional<double>(0.0)
                                                    : estimate.standard_error;
}

/// @param sense  +1 where the motion is towards positive displacement, −1 where it is not
SlipForce InSense(double sense, const ParameterEstimate& slip_force,
                  const ParameterEstimate& asymmetry, double correlation) {
  const double share = 1 + sense * asymmetry.value;
  const auto over_share = [&](std::optional<double> way) {
    if (way) *way /= share;
    return way;
  };
  const double correlation_in_sense = sense * correlation;
  SlipForce force{.value = slip_force.value * share};
  if (slip_force.status == ParameterStatus::kFixed && asymmetry.status == ParameterStatus::kFixed) {
    return force;
  }
  std::optional<double> error_of_slip_force = ErrorOf(slip_force);
  if (error_of_slip_force) *error_of_slip_force /= slip_force.value;
  if (const auto error =
          Together(error_of_slip_force, over_share(ErrorOf(asymmetry)), correlation_in_sense)) {
    force.standard_error = force.value * *error;
  }
  const auto& towards_lower = sense > 0 ? asymmetry.lower95 : asymmetry.upper95;
  const auto& towards_upper = sense > 0 ? asymmetry.upper95 : asymmetry.lower95;
  if (const auto way =
          Together(LogWayTo(slip_force, slip_force.lower95),
                   over_share(WayTo(asymmetry, towards_lower)), correlation_in_sense)) {
    force.lower95 = force.value * std::exp(-*way);
  }
  if (const auto way =
          Together(LogWayTo(slip_force, slip_force.upper95),
                   over_share(WayTo(asymmetry, towards_upper)), correlation_in_sense)) {
    force.upper95 = force.value * std::exp(*way);
  }
  return force;
}

}  // namespace

std::optional<SlipForces> DescribeSlipForces(const FitResult& fit) {
  const ParameterEstimate* const slip_force = fit.Find("slip_force");
  const ParameterEstimate* const asymmetry = fit.Find("asymmetry");
  if (slip_force == nullptr || asymmetry == nullptr || !slip_force->is_known() ||
      !asymmetry->is_known()) {
    return std::nullopt;
  }
  const bool both_are_free =
      slip_force->status != ParameterStatus::kFixed && asymmetry->status != ParameterStatus::kFixed;
  const double correlation = both_are_free ? Correlation(fit, "slip_force", "asymmetry") : 0.0;
  return SlipForces{.positive = InSense(1.0, *slip_force, *asymmetry, correlation),
                    .negative = InSense(-1.0, *slip_force, *asymmetry, correlation)};
}

}  // namespace mindahl::report
