#include <ceres/ceres.h>
#include <ceres/gradient_checker.h>

#include "mindahl/identification/ceres_problem.h"
#include "mindahl/identification/fit.h"
#include "recovery/recovered.h"
#include "support/joint.h"
#include "support/prelude.h"

// Dahl's own law whose force follows the torque carried and differs between the directions.
namespace mindahl::identification::joint_friction_test {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr int kSamples = 200;  // a cycle
// Samples are rounded to 1e-16; α, A and the offsets are told apart with a condition below 1e4.
constexpr double kExact = 1e-12;

/// Holds the drive of a joint: a motion of some knees, a torque about a mean.
struct Drive {
  BranchLaw law = {3e5, 1.0, 12.0};
  double asymmetry = -0.35;
  double knees = 3.0;
  double mean = 20.0;    // [N m]
  double swing = 45.0;   // beyond the mean the torque changes its sign
  std::size_t late = 0;  // samples that the force is read after the motion
};

Record RecordOf(const Drive& drive) {
  Record record;
  const double knee = drive.law.slip_force / drive.law.tangential_stiffness;
  for (int i = 0; i < 3 * kSamples; ++i) {
    const double phase = kTwoPi * i / kSamples;
    record.displacement.push_back(drive.knees * knee *
                                  (std::sin(phase) + 0.2 * std::sin(2 * phase)));
    record.normal_load.push_back(drive.mean + drive.swing * std::cos(2 * phase + 0.4));
    record.time.push_back(0.01 * i);
  }
  std::vector<double> motion(drive.late, 0.0);
  motion.insert(motion.end(), record.displacement.begin(),
                record.displacement.end() - static_cast<std::ptrdiff_t>(drive.late));
  record.force = testing::JointForces(drive.law, drive.asymmetry, motion, record.normal_load);
  return record;
}

FitOptions Options(std::vector<std::string> terms = {"asymmetry"}) {
  return {.model = models::FindFrictionModel("dahl"), .terms = std::move(terms)};
}

TEST(JointFriction, IsRecoveredUnderATorqueThatChangesItsSign) {
  for (const double alpha : {0.5, 1.0, 1.4}) {
    for (const double asymmetry : {-0.35, 0.2}) {
      const Drive drive{.law = {3e5, alpha, 12.0}, .asymmetry = asymmetry};
      const FitResult fit = FitOne(testing::Shifted(RecordOf(drive), 2e-5, 1.5), Options());
      EXPECT_TRUE(testing::Recovers(fit, drive.law, kExact)) << alpha << ' ' << asymmetry;
      EXPECT_NEAR(fit.Find("asymmetry")->value, asymmetry, kExact);
      EXPECT_EQ(fit.Find("asymmetry")->identifiability, Identifiability::kIdentifiable);
      EXPECT_NE(fit.FindFinding("load_varies", "followed"), nullptr);
    }
  }
}

TEST(JointFriction, IsToldFromAContactOfMasingsLawUnderATorqueThatVaries) {
  const Drive drive{.asymmetry = 0.0, .swing = 10.0};
  const FitResult fit = FitOne(RecordOf(drive));
  ASSERT_TRUE(fit.law_choice);
  EXPECT_TRUE(fit.prefers_other_law());
  EXPECT_LE(testing::WorstError(fit.law_choice->law, drive.law), 1e-9);
}

TEST(JointFriction, OfASettledJointDistinguishesTheAsymmetryFromTheOffset) {
  const Drive drive{.swing = 0.0};
  Record record = testing::From(RecordOf(drive), 2 * kSamples);
  record.normal_load.clear();
  FitOptions options = Options();
  options.initial_state = InitialState::kSteady;
  const FitResult fit = FitOne(testing::Shifted(record, 0.0, 1.5), options);
  // What was before the second cycle has left exp(−2·2·3·2) of itself: 4e-11.
  EXPECT_TRUE(testing::Recovers(fit, drive.law, 1e-9));
  EXPECT_NEAR(fit.Find("asymmetry")->value, drive.asymmetry, 1e-9);
  EXPECT_NEAR(fit.Find("force_offset")->value, 1.5, 1e-8);
  EXPECT_EQ(fit.FindFinding("not_identifiable", "below_slip"), nullptr);
}

TEST(JointFriction, OfATorqueOfTheOtherSignHasTheOtherAsymmetry) {
  for (const double mean : {30.0, -30.0}) {
    const Drive drive{.asymmetry = 0.25, .mean = mean, .swing = 0.0};
    const FitResult fit = FitOne(RecordOf(drive), Options());
    EXPECT_NEAR(fit.Find("asymmetry")->value, 0.25, kExact) << mean;
  }
}

TEST(JointFriction, ReadsTheTorqueWithTheForceWhereTheMotionIsEarlier) {
  const Drive drive{.late = 2};
  FitOptions options = Options({"asymmetry", "lag"});
  const Record record = RecordOf(drive);
  const FitResult fit = FitOne(record, options);
  // Samples whose motion is not in the record count neither for the fit nor for the mean torque,
  // over which μ = Tc/N̄ is one.
  double magnitude = 0.0;
  for (const double load : record.normal_load) magnitude += std::abs(load);
  const double friction = drive.law.slip_force * static_cast<double>(record.size()) / magnitude;
  ASSERT_TRUE(fit.normal_load);
  EXPECT_NEAR(fit.law.slip_force / *fit.normal_load / friction, 1.0, testing::kNoiseFree);
  EXPECT_NEAR(fit.law.slip_force / fit.law.tangential_stiffness / 4e-5, 1.0, testing::kNoiseFree);
  EXPECT_NEAR(fit.Find("lag")->value, 0.02, 1e-8);
  EXPECT_NEAR(fit.Find("asymmetry")->value, drive.asymmetry, testing::kNoiseFree);
}

}  // namespace
}  // namespace mindahl::identification::joint_friction_test
