#pragma once

#include <cmath>
#include <string_view>

#include "mindahl/core/error.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/variable_load.h"

namespace mindahl::models {

/// Holds displacement and force at which a contact under a load slips.
struct SlipAtLoad {
  double displacement = 0.0;  // δc(N) [m]
  double force = 0.0;         // Tc(N) [N]

  [[nodiscard]] bool IsInRange() const {
    return displacement <= kLargestPathDisplacement && std::isfinite(force);
  }
};

inline BranchLaw ReferenceLaw(const LoadDependentLaw& law) {
  return {law.reference_stiffness, law.shape_exponent,
          law.friction_coefficient * law.reference_load};
}

/// Returns δc(N_ref) [m].
inline double ReferenceSlipDisplacement(const LoadDependentLaw& law) {
  return GrossSlipDisplacement(ReferenceLaw(law));
}

/// Returns Tc = μN, δc = δc(N_ref)·(N/N_ref)^{1−α}.
inline SlipAtLoad SlipUnder(const LoadDependentLaw& law, double reference_slip_displacement,
                            double normal_load) {
  const double load_ratio = normal_load / law.reference_load;
  double growth = 0.0;
  if (law.shape_exponent == 1.0 / 3) {
    const double root = std::cbrt(load_ratio);
    growth = root * root;
  } else {
    growth = std::pow(load_ratio, 1 - law.shape_exponent);
  }
  return {reference_slip_displacement * growth, law.friction_coefficient * normal_load};
}

/// @throws InvalidArgument unless the load is one and keeps the contact within the range of the
///   arithmetic
inline void RequireLoad(std::string_view quantity, double normal_load, const SlipAtLoad& slip) {
  if (!(normal_load >= 0) || std::isinf(normal_load)) {
    ThrowInvalid(quantity, normal_load, "must be finite and >= 0");
  }
  if (!slip.IsInRange()) {
    ThrowInvalid(quantity, normal_load,
                 "must keep the slip force finite and its displacement <= 1e307 m");
  }
}

}  // namespace mindahl::models
