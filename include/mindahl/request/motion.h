#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"
#include "mindahl/request/contact_request.h"

namespace mindahl::request {

/// Holds what is asked for the motion of a contact: a waveform, or a file.
struct DriveRequest {
  std::string waveform = "sine";
  std::optional<double> lambda{};
  std::optional<double> amplitude{};
  models::ExcitationOptions excitation{.cycles = 1.0};
  std::string path{};
  std::string path_unit{};
  std::string load_column{};  ///< column of that file; "" = the load is constant
  std::string load_unit{};
  std::string force_path{};  ///< a file that imposes the force instead
  std::string force_path_unit{};
  std::uint64_t seed = 1;
};

/// One entry a row of output.
struct ImposedMotion {
  std::vector<double> time;              ///< [s]
  std::vector<double> displacement;      ///< [m]
  std::vector<double> envelope = {};     ///< [m]; empty unless the amplitude changes along the way
  std::vector<double> normal_load = {};  ///< [N]; empty unless a file gives it

  /// Valid as long as this.
  [[nodiscard]] methods::Drive drive() const { return {displacement, envelope}; }
};

/// A force imposed by a file, one entry a row of output.
struct ImposedForce {
  std::vector<double> time;   ///< [s], counting rows
  std::vector<double> force;  ///< [N], within ±Tc
};

/// @param law  at whose slip force the contact slides
/// @throws InputError naming the place in the file, also of a force that reaches slip
ImposedForce ReadImposedForce(const DriveRequest& request, const models::BranchLaw& law);

/// @param law  to which --lambda refers
/// @throws InputError or InvalidArgument naming the option, or the place in the file
ImposedMotion MakeMotion(const DriveRequest& request, const models::BranchLaw& law);

/// Holds forces in addition to the contact's; docs/theory.md §12 has the equations.
struct AddedForces {
  double viscous = 0.0;            // C [N s/m]
  double speed_exponent = 1.0;     // m [-]
  double inertia = 0.0;            // [kg]
  double slip_slope = 0.0;         // m₁ [-]
  double slip_curvature = 0.0;     // m₂ [-]
  double slip_trend = 0.0;         // K [-]
  double plateau_slope = 0.0;      // [N/m]
  double plateau_curvature = 0.0;  // [N/m²]
  std::optional<double> ripple{};  // λ [m]
  double ripple_amplitude = 0.0;   // [N]
  double ripple_phase_up = 0.0;    // φ₊ [rad]
  double ripple_phase_down = 0.0;  // φ₋ [rad]

  bool operator==(const AddedForces&) const = default;
};

/// Holds what is asked of a simulation: docs/contract.md, `mindahl simulate`.
struct SimulationRequest {
  std::string model = "mindlin";
  LawRequest law{};
  DriveRequest drive{};
  double asymmetry = 0.0;
  double backlash = 0.0;  ///< [m]
  AddedForces forces{};
  double force_noise = 0.0;         ///< standard deviation [N]
  double displacement_noise = 0.0;  ///< standard deviation [m]
  std::string method = "exact";
  std::optional<std::size_t> steps{};
  std::optional<double> tolerance{};
};

/// Returns the names of the models that may be simulated.
std::vector<std::string> SimulatedModels();

struct Simulation {
  ImposedMotion motion;
  std::vector<double> force;  ///< [N], one entry a row
};

/// Computes the force of a contact along a motion, or the motion under an imposed force.
/// @throws InputError or InvalidArgument naming the option, or the place in the file
Simulation Simulate(const SimulationRequest& request);

/// Returns time, displacement, force and a varying load as CSV, as `mindahl simulate` writes it.
std::string ToCsv(const Simulation& simulation);

}  // namespace mindahl::request
