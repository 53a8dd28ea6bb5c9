#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <span>

namespace mindahl::cli {

/// Forces of `simulate` in addition to the contact's; docs/theory.md §12 has the equations.
struct AddedForces {
  double viscous = 0.0;            // C [N s/m]
  double speed_exponent = 1.0;     // m [-]
  double inertia = 0.0;            // [kg]
  double slip_slope = 0.0;         // m₁ [-]
  double slip_curvature = 0.0;     // m₂ [-]
  double slip_trend = 0.0;         // K [-]
  double plateau_slope = 0.0;      // [N/m]
  double plateau_curvature = 0.0;  // [N/m²]
  std::optional<double> ripple;    // λ [m]
  double ripple_amplitude = 0.0;   // [N]
  double ripple_phase_up = 0.0;    // φ₊ [rad]
  double ripple_phase_down = 0.0;  // φ₋ [rad]

  bool operator==(const AddedForces&) const = default;
};

void AddAddedForceOptions(CLI::App& command, AddedForces& forces);

/// Adds the forces to those of the contact along a motion. Velocities and accelerations are central
/// differences, as a fit takes them; positions count from the middle of the motion, in its half
/// range where they have no unit.
/// @throws InvalidArgument for a speed exponent or a period that is not > 0, an amplitude without a
///   period, or a slip force that would not be positive over the motion
void AddForces(const AddedForces& forces, std::span<const double> time,
               std::span<const double> displacement, std::span<double> force);

}  // namespace mindahl::cli
