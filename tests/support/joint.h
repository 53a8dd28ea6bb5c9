#pragma once

#include <span>
#include <vector>

#include "mindahl/models/contact_state.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/joint_friction.h"

namespace mindahl::testing {

/// Returns the friction [N] of a joint that is at z = 0 at displacement 0, Tc being that under the
/// mean magnitude of the load.
inline std::vector<double> JointForces(const models::BranchLaw& law, double asymmetry,
                                       std::span<const double> displacement,
                                       std::span<const double> load) {
  double magnitude = 0.0;
  for (const double value : load) magnitude += std::abs(value);
  const double reference_load = magnitude / static_cast<double>(load.size());
  models::ContactState state(*models::FindFrictionModel("dahl"),
                             {law.tangential_stiffness / law.slip_force, law.shape_exponent, 1.0});
  std::vector<double> force;
  for (std::size_t i = 0; i < load.size(); ++i) {
    force.push_back(law.slip_force * models::JointForce(state.Move(displacement[i]),
                                                        load[i] / reference_load, asymmetry));
  }
  return force;
}

}  // namespace mindahl::testing
