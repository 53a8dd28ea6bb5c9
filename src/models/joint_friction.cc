#include "mindahl/models/joint_friction.h"

#include "mindahl/core/error.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::models {
namespace {

const FrictionModel& DahlsOwnLaw() { return *FindFrictionModel("dahl"); }

/// Returns the law of z: unit slip force, knee h = Tc/σ.
BranchLaw LawOfState(const JointFriction& joint) {
  Validate(joint);
  return {.tangential_stiffness = joint.law.tangential_stiffness / joint.law.slip_force,
          .shape_exponent = joint.law.shape_exponent,
          .slip_force = 1.0};
}

}  // namespace

void Validate(const JointFriction& joint) {
  Validate(joint.law);
  RequirePositive("reference load [N]", joint.reference_load);
  if (!(std::abs(joint.asymmetry) < 1)) {
    ThrowInvalid("asymmetry [-]", joint.asymmetry, "must be in (-1, 1)");
  }
}

void EvaluateJointFriction(const JointFriction& joint, std::span<const double> displacement,
                           std::span<const double> load, std::span<double> force) {
  RequireSameSize("displacement", displacement.size(), "load", load.size());
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  JointState state(joint);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = state.Move(displacement[i], load[i]);
}

JointState::JointState(const JointFriction& joint, double unloaded_displacement)
    : joint_(joint),
      state_(DahlsOwnLaw(), LawOfState(joint), {.unloaded_displacement = unloaded_displacement}) {}

double JointState::ForceOf(double state, double load) const {
  return joint_.law.slip_force * JointForce(state, load / joint_.reference_load, joint_.asymmetry);
}

double JointState::Move(double displacement, double load) {
  RequireFinite("load [N]", load);
  return ForceOf(state_.Move(displacement), load);
}

double JointState::Peek(double displacement, double load) const {
  RequireFinite("load [N]", load);
  return ForceOf(state_.Peek(displacement), load);
}

double JointState::TangentStiffness(double load) const {
  RequireFinite("load [N]", load);
  return joint_.law.slip_force * state_.TangentStiffness() *
         JointForceSlope(state_.Force(), load / joint_.reference_load, joint_.asymmetry);
}

}  // namespace mindahl::models
