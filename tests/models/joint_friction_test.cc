#include "mindahl/models/joint_friction.h"

#include "support/prelude.h"

namespace mindahl::models::joint_friction_test {
namespace {

constexpr double kAsymmetry = -0.35;

TEST(JointFriction, SlipsAtOnePlusOrMinusTheAsymmetryUnderTheReferenceLoad) {
  EXPECT_DOUBLE_EQ(JointForce(1, 1, kAsymmetry), 1 - 0.35);
  EXPECT_DOUBLE_EQ(JointForce(-1, 1, kAsymmetry), -1 - 0.35);
  // A load of the other sign is carried by the other flank: the directions change places.
  EXPECT_DOUBLE_EQ(JointForce(1, -1, kAsymmetry), 1 + 0.35);
  EXPECT_DOUBLE_EQ(JointForce(1, 0.5, kAsymmetry), (1 - 0.35) / 2);
  EXPECT_EQ(JointForce(1, 0, kAsymmetry), 0.0);
}

TEST(JointFriction, HasTheSlopeOfItsForce) {
  constexpr double kStep = 1e-6;
  for (const double state : {-0.9, -0.2, 0.0, 0.7}) {
    for (const double load : {-1.5, 0.0, 0.4, 2.0}) {
      const double slope = (JointForce(state + kStep, load, kAsymmetry) -
                            JointForce(state - kStep, load, kAsymmetry)) /
                           (2 * kStep);
      // A parabola: the rounding of two forces over the step.
      EXPECT_NEAR(JointForceSlope(state, load, kAsymmetry), slope, 1e-9);
    }
  }
}

}  // namespace
}  // namespace mindahl::models::joint_friction_test
