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
  /// Column of that file, as of RecordColumns; "": the first, or the one of a recognised name.
  std::string displacement{};
  std::string load_column{};  ///< likewise, of the normal load; "": the load is constant
  std::string force_path{};   ///< a file that imposes the force instead
  std::string force{};        ///< column of that file, likewise
  std::uint64_t seed = 1;
};

/// One entry a row of output.
struct ImposedMotion {
  std::vector<double> time = {};          ///< [s]
  std::vector<double> displacement = {};  ///< [m]
  std::vector<double> envelope = {};      ///< [m]; empty unless the amplitude changes along the way
  std::vector<double> normal_load = {};   ///< [N]; empty unless a file gives it

  /// Valid as long as this.
  [[nodiscard]] methods::Drive drive() const { return {displacement, envelope}; }
};

/// @param law  to which --lambda refers
/// @throws InputError or InvalidArgument naming the option, or the place in the file
ImposedMotion MakeMotion(const DriveRequest& request, const models::BranchLaw& law);

/// Holds what is asked of a simulation: docs/contract.md, `mindahl simulate`.
struct SimulationRequest {
  std::string model = "mindlin";
  LawRequest law{};
  DriveRequest drive{};
  double asymmetry = 0.0;           ///< A of slip forces Tc(1 ± A) [-]
  double force_noise = 0.0;         ///< standard deviation [N]
  double displacement_noise = 0.0;  ///< standard deviation [m]
  std::string method = "exact";
  std::optional<std::size_t> steps{};
  std::optional<double> tolerance{};
};

/// Returns the names of the models that may be simulated.
std::vector<std::string> SimulatedModels();

struct Simulation {
  ImposedMotion motion = {};
  std::vector<double> force = {};  ///< [N], one entry a row
};

/// Computes the force of a contact along a motion, or the motion under an imposed force.
/// @throws InputError or InvalidArgument naming the option, or the place in the file
Simulation Simulate(const SimulationRequest& request);

/// Returns time, displacement, force and a varying load as CSV, as `mindahl simulate` writes it.
std::string ToCsv(const Simulation& simulation);

}  // namespace mindahl::request
