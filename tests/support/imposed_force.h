#pragma once

#include <span>
#include <vector>

#include "mindahl/loop/reversals.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "models/normalized_response.h"

namespace mindahl::testing {

/// Returns the displacement [m] along an imposed force [N] below Tc, of a contact that is unloaded
/// at displacement 0.
inline std::vector<double> DisplacementUnder(const models::FrictionModel& model,
                                             const models::BranchLaw& law,
                                             std::span<const double> force) {
  const models::LoadingPath path =
      models::MakeLoadingPath(force, loop::FindReversals(force, 0.0), model.memory, {});
  std::vector<double> displacement(force.size());
  models::EvaluateNormalizedDisplacement(model, {law.slip_force, law.shape_exponent}, path, force,
                                         displacement);
  for (double& each : displacement) each *= law.slip_force / law.tangential_stiffness;
  return displacement;
}

}  // namespace mindahl::testing
