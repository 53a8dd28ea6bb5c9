#pragma once

#include <fmt/format.h>

#include <cmath>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/response.h"

namespace mindahl::models {

inline bool IsRigid(const SeriesSpring& rig) {
  return std::isinf(rig.stiffness) && rig.stiffness > 0;
}

/// Returns c = Tc/k_r [m], the spring's travel at slip.
/// @throws InvalidArgument where the rig cannot be accounted for
inline double SpringTravel(const FrictionModel& model, const BranchLaw& law,
                           const SeriesSpring& rig) {
  Validate(rig);
  if (model.scaled_by_peak) {
    throw InvalidArgument(fmt::format(
        "model {} is scaled by the peak at the contact's own amplitude: must have a rigid rig, not "
        "a series stiffness [N/m] = {:.6g}",
        model.name, rig.stiffness));
  }
  // Compared before it is divided by, for no quotient to overflow.
  constexpr double kSoftest = 1 / backbone::kLargestSeriesCompliance<double>;
  constexpr double kLongest = 1e300;  // [m]
  if (rig.stiffness < kSoftest * law.tangential_stiffness ||
      rig.stiffness < law.slip_force / kLongest) {
    ThrowInvalid("series stiffness [N/m]", rig.stiffness,
                 "must be >= 1e-100 of the tangential stiffness and let the rig travel <= 1e300 m");
  }
  return law.slip_force / rig.stiffness;
}

}  // namespace mindahl::models
