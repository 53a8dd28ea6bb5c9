#include "cli/added_forces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "mindahl/core/error.h"

namespace mindahl::cli {
namespace {

/// Central differences over time, one-sided at the ends; 0 where time stands still.
std::vector<double> RateOf(std::span<const double> time, std::span<const double> values) {
  std::vector<double> rate(values.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, values.size() - 1);
    const double duration = time[after] - time[before];
    if (duration > 0) rate[i] = (values[after] - values[before]) / duration;
  }
  return rate;
}

void RequireForces(const AddedForces& forces) {
  RequirePositive("--speed-exponent [-]", forces.speed_exponent);
  if (forces.ripple) RequirePositive("--ripple [m]", *forces.ripple);
  if (!forces.ripple && forces.ripple_amplitude != 0) {
    throw InputError("--ripple-amplitude needs a period: add --ripple PERIOD");
  }
  if (!(std::abs(forces.slip_slope) + std::abs(forces.slip_curvature) +
            std::abs(forces.slip_trend) <
        1)) {
    throw InputError(
        "--slip-slope, --slip-curvature and --slip-trend: together they must be below 1, for the "
        "slip force to be positive over the whole motion");
  }
}

}  // namespace

void AddAddedForceOptions(CLI::App& command, AddedForces& forces) {
  const std::string group = "Forces in addition to the contact's";
  const auto add = [&](const char* name, auto& value, const char* help, const char* unit) {
    command.add_option(name, value, help)->type_name(unit)->group(group);
  };
  add("--viscous", forces.viscous, "C of a viscous force C·dδ/dt [N s/m]", "C");
  add("--speed-exponent", forces.speed_exponent, "of C·sgn(v)|v|^M in its place, v in m/s [-]",
      "M");
  add("--inertia", forces.inertia, "mass of a force M·d²δ/dt² [kg]", "M");
  add("--slip-slope", forces.slip_slope,
      "m1 of forces times 1 + m1·x + m2·x², x the position from −1\nto 1 [-]", "M1");
  add("--slip-curvature", forces.slip_curvature, "m2, likewise [-]", "M2");
  add("--slip-trend", forces.slip_trend,
      "K of forces times 1 + K·τ, τ the time from −1 at the record's\nbeginning to 1 at its end "
      "[-]",
      "K");
  add("--plateau-slope", forces.plateau_slope, "of a force slope·δ [N/m]", "K");
  add("--plateau-curvature", forces.plateau_curvature, "of a force curvature·δ² [N/m²]", "K");
  add("--ripple", forces.ripple, "period of a force over the position [m]", "PERIOD");
  add("--ripple-amplitude", forces.ripple_amplitude, "its amplitude [N]", "A");
  add("--ripple-phase-up", forces.ripple_phase_up, "its phase where the displacement grows [rad]",
      "PHI");
  add("--ripple-phase-down", forces.ripple_phase_down, "where it falls [rad]", "PHI");
}

void AddForces(const AddedForces& forces, std::span<const double> time,
               std::span<const double> displacement, std::span<double> force) {
  RequireForces(forces);
  if (forces == AddedForces{}) return;
  const auto [lowest, highest] = std::ranges::minmax(displacement);
  const double middle = lowest + (highest - lowest) / 2;
  const double half = (highest - lowest) / 2;
  const std::vector<double> velocity = RateOf(time, displacement);
  const std::vector<double> acceleration = RateOf(time, velocity);
  const double duration = time.empty() ? 0.0 : time.back() - time.front();
  double direction = 1.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (i > 0 && displacement[i] != displacement[i - 1]) {
      direction = displacement[i] > displacement[i - 1] ? 1.0 : -1.0;
    }
    const double from_middle = displacement[i] - middle;
    const double position = half > 0 ? from_middle / half : 0.0;
    const double elapsed = time[i] - time.front();
    const double tau = duration > 0 ? 2 * elapsed / duration - 1 : 0.0;
    force[i] *= 1 + position * (forces.slip_slope + forces.slip_curvature * position) +
                forces.slip_trend * tau;
    force[i] += forces.inertia * acceleration[i] +
                from_middle * (forces.plateau_slope + forces.plateau_curvature * from_middle);
    if (forces.viscous != 0) {
      force[i] +=
          forces.viscous *
          std::copysign(std::pow(std::abs(velocity[i]), forces.speed_exponent), velocity[i]);
    }
    if (forces.ripple) {
      const double phase = direction > 0 ? forces.ripple_phase_up : forces.ripple_phase_down;
      force[i] += forces.ripple_amplitude *
                  std::cos(2 * std::numbers::pi * from_middle / *forces.ripple + phase);
    }
  }
}

}  // namespace mindahl::cli
