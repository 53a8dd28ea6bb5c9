#include "mindahl/models/joint_friction.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "mindahl/models/response.h"
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

TEST(JointState, IsTheSameHoweverItsStepsAreSplit) {
  const History history = Drive(kDrive.law.slip_force / kDrive.law.tangential_stiffness);
  std::vector<double> force(history.load.size());
  EvaluateJointFriction(kDrive, history.displacement, history.load, force);
  JointState whole(kDrive);
  JointState split(kDrive);
  double before = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double largest = kError * kDrive.law.slip_force * 65 / 30;  // of the largest load
    const double peeked = whole.Peek(history.displacement[i], history.load[i]);
    EXPECT_EQ(whole.Move(history.displacement[i], history.load[i]), peeked);
    EXPECT_NEAR(peeked, force[i], largest);
    for (int part = 1; part <= 5; ++part) {
      // The load on the way leaves nothing behind.
      split.Move(std::lerp(before, history.displacement[i], part / 5.0),
                 part == 5 ? history.load[i] : -7);
    }
    before = history.displacement[i];
    EXPECT_NEAR(split.Peek(before, history.load[i]), force[i], largest);
  }
}

TEST(JointState, HasTheTangentOfItsForce) {
  JointState joint(kDrive);
  const double knee = kDrive.law.slip_force / kDrive.law.tangential_stiffness;
  double at = 0.0;
  for (const double move : {0.4, 0.3, -0.9, -0.2, 1.3}) {
    at += move * knee;
    for (const double load : {17.0, -17.0}) {
      joint.Move(at, load);
      const double step = std::copysign(1e-6 * knee, move);
      const double slope = (joint.Peek(at + step, load) - joint.Peek(at, load)) / step;
      // Half a step times the second derivative, and the rounding of two forces over the step.
      EXPECT_NEAR(joint.TangentStiffness(load) / slope, 1.0, 1e-5) << move << ", " << load;
    }
  }
  joint.Reset();
  EXPECT_EQ(joint.State(), 0.0);
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
  JointState joint(kDrive);
  EXPECT_THROW(joint.Move(1e-6, infinite[0]), InvalidArgument);
  EXPECT_EQ(joint.State(), 0.0);
}

}  // namespace
}  // namespace mindahl::models::joint_friction_test
