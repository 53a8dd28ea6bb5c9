#include "mindahl/models/joint_friction.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "mindahl/models/contact_state.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::models::joint_friction_test {
namespace {

using Wide = boost::multiprecision::cpp_bin_float_50;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// z has the error of Dahl's own law, 5e-14 (response.h); T at most 1 + 2|A| times as much, |A| < 1.
constexpr double kError = 3 * 5e-14;

const JointFriction kDrive{.law = {2e5, 1.0, 12.0}, .reference_load = 30.0, .asymmetry = -0.35};

struct History {
  std::vector<double> displacement;
  std::vector<double> load;
};

/// A path of unequal turns that starts downwards, under a load that changes its sign.
History Drive(double knee) {
  History history;
  for (int i = 0; i < 400; ++i) {
    const double phase = 0.05 * i;
    history.displacement.push_back(knee * (-1.5 * std::sin(phase) + 0.8 * std::sin(2.7 * phase)));
    history.load.push_back(20 + 45 * std::cos(0.37 * phase));
  }
  return history;
}

/// z in 50 digits: the closed form on each monotone piece, v = 1 − s·z.
std::vector<Wide> StateOf(const JointFriction& joint, const std::vector<double>& displacement) {
  const Wide alpha(joint.law.shape_exponent);
  const Wide rate = Wide(joint.law.tangential_stiffness) / joint.law.slip_force;
  std::vector<Wide> states;
  Wide z = 0;
  Wide before = 0;
  for (const double value : displacement) {
    const Wide step = Wide(value) - before;
    const Wide s = step < 0 ? -1 : 1;
    const Wide v = 1 - s * z;
    Wide left = 0;
    if (alpha == 1) {
      left = v * exp(-rate * abs(step));
    } else {
      const Wide power = pow(v, 1 - alpha) - (1 - alpha) * rate * abs(step);
      left = power > 0 ? Wide(pow(power, 1 / (1 - alpha))) : Wide(0);
    }
    z = s * (1 - left);
    before = value;
    states.push_back(z);
  }
  return states;
}

TEST(JointFriction, IsTheClosedFormOfEachMonotonePieceTimesTheLoad) {
  for (const double alpha : {0.0, 1.0 / 3, 1.0, 1.7}) {
    JointFriction joint = kDrive;
    joint.law.shape_exponent = alpha;
    const History history = Drive(joint.law.slip_force / joint.law.tangential_stiffness);
    std::vector<double> force(history.load.size());
    EvaluateJointFriction(joint, history.displacement, history.load, force);
    const std::vector<Wide> states = StateOf(joint, history.displacement);
    for (std::size_t i = 0; i < force.size(); ++i) {
      const Wide load = Wide(history.load[i]) / joint.reference_load;
      const Wide expected = joint.law.slip_force * (abs(load) * states[i] +
                                                    joint.asymmetry * load * states[i] * states[i]);
      EXPECT_NEAR(force[i], static_cast<double>(expected),
                  kError * joint.law.slip_force * std::abs(static_cast<double>(load)) + kEpsilon)
          << alpha << ' ' << i;
    }
  }
}

TEST(JointFriction, SlipsAtTcOnePlusOrMinusTheAsymmetryUnderTheReferenceLoad) {
  const std::vector<double> far = {100 * kDrive.law.slip_force / kDrive.law.tangential_stiffness};
  std::vector<double> force(1);
  const auto at = [&](double sign, double load) {
    const std::vector<double> displacement = {sign * far[0]};
    EvaluateJointFriction(kDrive, displacement, std::vector<double>{load}, force);
    return force[0];
  };
  const double rounding = 4 * kEpsilon * kDrive.law.slip_force;
  EXPECT_NEAR(at(1, 30), 12 * (1 - 0.35), rounding);
  EXPECT_NEAR(at(-1, 30), -12 * (1 + 0.35), rounding);
  // A load of the other sign is carried by the other flank: the directions change places.
  EXPECT_NEAR(at(1, -30), 12 * (1 + 0.35), rounding);
  EXPECT_NEAR(at(1, 15), 6 * (1 - 0.35), rounding);
  EXPECT_EQ(at(1, 0), 0.0);
}

TEST(JointFriction, IsTheForceOfAStateThatIsMovedStepByStep) {
  const History history = Drive(kDrive.law.slip_force / kDrive.law.tangential_stiffness);
  std::vector<double> force(history.load.size());
  EvaluateJointFriction(kDrive, history.displacement, history.load, force);
  ContactState split(Model("dahl"), LawOfState(kDrive));
  double before = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    for (int part = 1; part <= 5; ++part) {
      split.Move(std::lerp(before, history.displacement[i], part / 5.0));
    }
    before = history.displacement[i];
    const double load = history.load[i] / kDrive.reference_load;
    EXPECT_NEAR(kDrive.law.slip_force * JointForce(split.Force(), load, kDrive.asymmetry), force[i],
                kError * kDrive.law.slip_force * 65 / 30);  // of the largest load
    // Half a step times the second derivative, and the rounding of two forces over the step.
    constexpr double kStep = 1e-6;
    const double slope = (JointForce(split.Force() + kStep, load, kDrive.asymmetry) -
                          JointForce(split.Force() - kStep, load, kDrive.asymmetry)) /
                         (2 * kStep);
    EXPECT_NEAR(JointForceSlope(split.Force(), load, kDrive.asymmetry), slope, 1e-9);
  }
}

TEST(JointFriction, RefusesWhatIsNoJoint) {
  std::vector<double> force(1);
  const std::vector<double> one = {1e-6};
  EXPECT_THROW(EvaluateJointFriction({.law = {1, 1, 1}, .asymmetry = 1}, one, one, force),
               InvalidArgument);
  EXPECT_THROW(EvaluateJointFriction({.law = {1, 1, 1}, .reference_load = 0}, one, one, force),
               InvalidArgument);
  const std::vector<double> infinite = {std::numeric_limits<double>::infinity()};
  EXPECT_THROW(EvaluateJointFriction(kDrive, one, infinite, force), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::joint_friction_test
