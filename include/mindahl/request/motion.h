#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"

namespace mindahl::request {

/// Holds what is asked for the motion of a contact: a waveform, or a file.
struct DriveRequest {
  std::string waveform = "sine";
  std::optional<double> lambda;
  std::optional<double> amplitude;
  models::ExcitationOptions excitation{.cycles = 1.0};
  std::string path;
  std::string path_unit;
  std::string load_column;  ///< column of that file; "" = the load is constant
  std::string load_unit;
  std::string force_path;  ///< a file that imposes the force instead
  std::string force_path_unit;
  std::uint64_t seed = 1;
};

/// One entry a row of output.
struct ImposedMotion {
  std::vector<double> time;          ///< [s]
  std::vector<double> displacement;  ///< [m]
  std::vector<double> envelope;      ///< [m]; empty unless the amplitude changes along the way
  std::vector<double> normal_load;   ///< [N]; empty unless a file gives it

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

}  // namespace mindahl::request
