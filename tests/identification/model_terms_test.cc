#include "identification/sample_loop.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// What a fit may add to the contact - a rig's spring, a sloped plateau, drift, a varying load - and
// what it may leave out.
namespace mindahl::identification::model_terms_test {
namespace {

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kRig = 6e7;  // [N/m]

/// Contact and rig are told apart by the law's curvature alone: the condition of the fit, 1e4 for
/// the contact alone, is some hundred times larger.
constexpr double kWithRig = 1e-6;

TEST(ModelTerms, KnownRigStiffnessLeavesTheContactsOwnParameters) {
  const FitResult fit = FitOne(SprungLoop(kMindlin, kRig), {.fixed = {{"rig_stiffness", kRig}}});
  EXPECT_TRUE(Recovers(fit, kMindlin, kWithRig));
  EXPECT_DOUBLE_EQ(fit.rig.stiffness, kRig);
  EXPECT_EQ(fit.Find("rig_stiffness")->status, ParameterStatus::kFixed);
}

TEST(ModelTerms, RigStiffnessIsRecoveredWithAGivenShapeAndWithAFreeOne) {
  for (const char* model : {"mindlin", "mindlin-dahl"}) {
    const FitResult fit =
        FitOne(SprungLoop(kMindlin, kRig), {.model = &Model(model), .terms = {"rig_stiffness"}});
    EXPECT_TRUE(Recovers(fit, kMindlin, kWithRig)) << model;
    EXPECT_NEAR(fit.rig.stiffness, kRig, kWithRig * kRig) << model;
    EXPECT_EQ(fit.Find("rig_stiffness")->value, fit.rig.stiffness);
  }
}

TEST(ModelTerms, JenkinsElementInARigIsAJenkinsElementOfBothInSeries) {
  constexpr BranchLaw kJenkins{4e7, 0.0, 40.0};
  constexpr BranchLaw kTogether{1 / (1 / 4e7 + 1 / kRig), 0.0, 40.0};
  EXPECT_TRUE(Recovers(FitOne(SprungLoop(kJenkins, kRig), {.model = &Model("jenkins")}), kTogether,
                       kNoiseFree));
}

TEST(ModelTerms, ViscousForceIsRecovered) {
  // A dashpot beside the contact: C·dδ/dt, of 8 % of Tc at the greatest speed of the sine, which
  // central differences of 120 samples a cycle know to (2π/120)²/6 = 5e-4.
  constexpr double kPeriod = 2.0;  // [s]
  constexpr double kPi = 3.141592653589793;
  const double fastest = 2 * kPi * kReach / kPeriod;
  const double viscosity = 0.08 * kLaw.slip_force / fastest;
  Record record = Timed(Loop(), kPeriod / 120, 30.0);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += viscosity * fastest * std::cos(2 * kPi * (record.time[i] - 30) / kPeriod);
  }
  constexpr double kDifferences = 2e-3;
  const FitOptions options{.terms = {"viscous"}};
  const FitResult fit = FitOne(record, options);
  EXPECT_TRUE(Recovers(fit, kLaw, kDifferences));
  EXPECT_NEAR(fit.Find("viscous")->value / viscosity, 1, 2e-2);
  EXPECT_EQ(fit.Find("viscous")->unit, "N s/m");
  EXPECT_FALSE(Recovers(FitOne(record), kLaw, 0.02)) << "it matters";

  // Known, it is taken off; of two records of unequal length it is one and the same.
  EXPECT_TRUE(Recovers(FitOne(record, {.fixed = {{"viscous", viscosity}}}), kLaw, kDifferences));
  FitOptions of_both = options;
  of_both.initial_state = InitialState::kSteady;
  const FitResult joint =
      Fit(std::vector{From(record, record.size() / 3), From(record, record.size() / 2)}, of_both);
  EXPECT_TRUE(Recovers(joint, kLaw, kDifferences));
  EXPECT_NEAR(joint.Find("viscous")->value / viscosity, 1, 2e-2);

  record.time.clear();
  EXPECT_EQ(RefusalOf({record}, options), "viscous needs the time of every sample in every record");
}

}  // namespace
}  // namespace mindahl::identification::model_terms_test
