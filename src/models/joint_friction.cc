#include "mindahl/models/joint_friction.h"

#include "mindahl/core/error.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::models {

void Validate(const JointFriction& joint) {
  Validate(joint.law);
  RequirePositive("reference load [N]", joint.reference_load);
  if (!(std::abs(joint.asymmetry) < 1)) {
    ThrowInvalid("asymmetry [-]", joint.asymmetry, "must be in (-1, 1)");
  }
}

BranchLaw LawOfState(const JointFriction& joint) {
  Validate(joint);
  return {.tangential_stiffness = joint.law.tangential_stiffness / joint.law.slip_force,
          .shape_exponent = joint.law.shape_exponent,
          .slip_force = 1.0};
}

void EvaluateJointFriction(const JointFriction& joint, std::span<const double> displacement,
                           std::span<const double> load, std::span<double> force) {
  RequireSameSize("displacement", displacement.size(), "load", load.size());
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  ContactState state(*FindFrictionModel("dahl"), LawOfState(joint));
  for (std::size_t i = 0; i < force.size(); ++i) {
    RequireFinite("load [N]", load[i]);
    force[i] = joint.law.slip_force * JointForce(state.Move(displacement[i]),
                                                 load[i] / joint.reference_load, joint.asymmetry);
  }
}

}  // namespace mindahl::models
