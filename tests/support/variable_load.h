#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "mindahl/models/branch_law.h"
#include "models/load_zones.h"

namespace mindahl::testing {

/// Friction under a normal load that varies, as the zones of models/load_zones.h have it.
struct LoadDependentLaw {
  double friction_coefficient = 0.0;
  double reference_load = 0.0;       ///< [N]
  double reference_stiffness = 0.0;  ///< [N/m], at the reference load
  double shape_exponent = 1.0 / 3.0;
};

/// Returns the branch law under the reference load.
inline models::BranchLaw ReferenceLaw(const LoadDependentLaw& law) {
  return {law.reference_stiffness, law.shape_exponent,
          law.friction_coefficient * law.reference_load};
}

/// A contact that is unloaded at 0 under a first load, and moved step by step.
class LoadedContact {
 public:
  LoadedContact(const LoadDependentLaw& law, double normal_load)
      : law_(law), contact_(RimUnder(normal_load), 0.0) {}

  /// Returns the force [N] at a displacement [m] and a load [N].
  double Move(double displacement, double normal_load) {
    const models::LoadRim<double> rim = RimUnder(normal_load);
    models::backbone::WithShape(law_.shape_exponent, [&](const auto& shape) {
      MoveTo(rim, displacement, models::ShareOfWidth{shape, law_.shape_exponent}, contact_);
    });
    return contact_.force;
  }

  [[nodiscard]] std::size_t zones() const { return contact_.zones.size(); }

 private:
  /// Returns Tc = μN, δc = δc(N_ref)·(N/N_ref)^{1−α}.
  [[nodiscard]] models::LoadRim<double> RimUnder(double normal_load) const {
    const double load_ratio = normal_load / law_.reference_load;
    const double root = std::cbrt(load_ratio);
    const double growth = law_.shape_exponent == 1.0 / 3
                              ? root * root
                              : std::pow(load_ratio, 1 - law_.shape_exponent);
    return {GrossSlipDisplacement(ReferenceLaw(law_)) * growth,
            law_.friction_coefficient * normal_load};
  }

  LoadDependentLaw law_;
  models::ZonedContact<double> contact_;
};

/// Computes the force [N] at each sample of a path, unloaded at 0 under its first load.
inline void EvaluateForceUnderLoad(const LoadDependentLaw& law,
                                   std::span<const double> displacement,
                                   std::span<const double> normal_load, std::span<double> force) {
  LoadedContact contact(law, normal_load.front());
  for (std::size_t i = 0; i < force.size(); ++i) {
    force[i] = contact.Move(displacement[i], normal_load[i]);
  }
}

}  // namespace mindahl::testing
