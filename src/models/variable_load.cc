#include "mindahl/models/variable_load.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "mindahl/core/error.h"
#include "mindahl/models/loaded_contact_state.h"
#include "mindahl/models/loading_path.h"
#include "models/load_zones.h"
#include "models/requirements.h"

namespace mindahl::models {
namespace {

/// @throws InvalidArgument naming the first sample that is no step of a contact
void RequireSamples(const LoadDependentLaw& law, std::span<const double> displacement,
                    std::span<const double> normal_load) {
  const double reference = models::ReferenceSlipDisplacement(law);
  double largest_load = 0.0;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (!models::IsWithinReach(displacement[i])) {
      models::RequireWithinReach(fmt::format("displacement [m] of sample {}", i), displacement[i]);
    }
    // All reasons to refuse a load but its sign grow with it.
    if (normal_load[i] >= 0 && normal_load[i] <= largest_load) continue;
    const models::SlipAtLoad slip = models::SlipUnder(law, reference, normal_load[i]);
    if (!slip.IsInRange() || !(normal_load[i] >= 0)) {
      models::RequireLoad(fmt::format("normal load [N] of sample {}", i), normal_load[i], slip);
    }
    largest_load = normal_load[i];
  }
}

}  // namespace

void Validate(const LoadDependentLaw& law) {
  RequirePositive("friction coefficient [-]", law.friction_coefficient);
  RequirePositive("reference load [N]", law.reference_load);
  RequirePositive("reference stiffness [N/m]", law.reference_stiffness);
  RequireNonNegative("shape exponent [-]", law.shape_exponent);
  if (law.shape_exponent >= 1) {
    ThrowInvalid("shape exponent [-]", law.shape_exponent,
                 "must be < 1 under a varying load: slip is complete at a finite displacement");
  }
  const BranchLaw reference = models::ReferenceLaw(law);
  Validate(reference);
  const double slip_displacement = GrossSlipDisplacement(reference);
  if (!(slip_displacement <= kLargestPathDisplacement)) {
    ThrowInvalid("gross-slip displacement [m] at the reference load", slip_displacement,
                 "must be <= 1e307 m");
  }
}

BranchLaw BranchLawAtLoad(const LoadDependentLaw& law, double normal_load) {
  Validate(law);
  RequirePositive("normal load [N]", normal_load);
  const double load_ratio = normal_load / law.reference_load;
  const double growth = law.shape_exponent == 1.0 / 3 ? std::cbrt(load_ratio)
                                                      : std::pow(load_ratio, law.shape_exponent);
  const BranchLaw at_load{law.reference_stiffness * growth, law.shape_exponent,
                          law.friction_coefficient * normal_load};
  Validate(at_load);
  return at_load;
}

void EvaluateForceUnderLoad(const LoadDependentLaw& law, std::span<const double> displacement,
                            std::span<const double> normal_load, std::span<double> force) {
  Validate(law);
  RequireSameSize("displacement", displacement.size(), "normal load", normal_load.size());
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  if (displacement.empty()) return;
  RequireSamples(law, displacement, normal_load);
  models::LoadedContactState contact(law, {.normal_load = normal_load.front()});
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    force[i] = contact.Move(displacement[i], normal_load[i]);
  }
}

}  // namespace mindahl::models
