#include "identification/sample_loop.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// What a fit may add to the contact - a rig's spring, a sloped plateau, drift, a varying load - and
// what it may leave out.
namespace mindahl::identification::model_terms_test {
namespace {

using namespace loop;
using namespace models;

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kRig = 6e7;  // [N/m]

/// Contact and rig are told apart by the law's curvature alone: the condition of the fit, 1e4 for
/// the contact alone, is some hundred times larger.
constexpr double kWithRig = 1e-6;

TEST(ModelTerms, KnownRigStiffnessLeavesTheContactsOwnParameters) {
  FitOptions options;
  options.fixed["rig_stiffness"] = kRig;
  const FitResult fit = FitOne(SprungLoop(kMindlin, kRig), options);
  EXPECT_TRUE(Recovers(fit, kMindlin, kWithRig));
  EXPECT_DOUBLE_EQ(fit.rig.stiffness, kRig);
  EXPECT_EQ(fit.Find("rig_stiffness")->status, ParameterStatus::kFixed);
}

TEST(ModelTerms, RigStiffnessIsRecoveredWithAGivenShapeAndWithAFreeOne) {
  FitOptions options;
  options.terms.emplace_back("rig_stiffness");
  for (const bool held : {true, false}) {
    if (held) options.fixed["alpha"] = 1.0 / 3;
    if (!held) options.fixed.clear();
    const FitResult fit = FitOne(SprungLoop(kMindlin, kRig), options);
    EXPECT_TRUE(Recovers(fit, kMindlin, kWithRig)) << held;
    EXPECT_NEAR(fit.rig.stiffness, kRig, kWithRig * kRig) << held;
    EXPECT_EQ(fit.Find("rig_stiffness")->value, fit.rig.stiffness);
  }
}

TEST(ModelTerms, JenkinsElementInARigIsAJenkinsElementOfBothInSeries) {
  constexpr BranchLaw kJenkins{4e7, 0.0, 40.0};
  constexpr BranchLaw kTogether{1 / (1 / 4e7 + 1 / kRig), 0.0, 40.0};
  FitOptions options;
  options.model = &Model("jenkins");
  EXPECT_TRUE(Recovers(FitOne(SprungLoop(kJenkins, kRig), options), kTogether, kNoiseFree));
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
  FitOptions options;
  options.terms.emplace_back("viscous");
  const FitResult fit = FitOne(record, options);
  EXPECT_TRUE(Recovers(fit, kLaw, kDifferences));
  EXPECT_NEAR(fit.Find("viscous")->value / viscosity, 1, 2e-2);
  EXPECT_EQ(fit.Find("viscous")->unit, "N s/m");
  EXPECT_FALSE(Recovers(FitOne(record), kLaw, 0.02)) << "it matters";

  // Known, it is taken off; of two records of unequal length it is one and the same.
  options = {};
  options.fixed["viscous"] = viscosity;
  EXPECT_TRUE(Recovers(FitOne(record, options), kLaw, kDifferences));
  options.fixed.clear();
  options.terms.emplace_back("viscous");
  Record half = record;
  for (std::vector<double>* column : {&half.displacement, &half.force, &half.time}) {
    column->resize(record.size() / 2);
  }
  const FitResult joint = Fit(std::vector<Record>{record, half}, options);
  EXPECT_TRUE(Recovers(joint, kLaw, kDifferences));
  EXPECT_NEAR(joint.Find("viscous")->value / viscosity, 1, 2e-2);

  record.time.clear();
  EXPECT_EQ(RefusalOf({record}, options), "viscous needs the time of every sample in every record");
}

TEST(ModelTerms, OptionsThatBreakARuleAreNamed) {
  FitOptions options;
  options.preparation.displacement_noise = -1e-9;
  EXPECT_EQ(RefusalOf({Loop()}, options),
            "displacement noise [m] = -1e-09 is invalid: must be finite and >= 0");
  options = {};
  options.preparation.load_window = {90.0, 110.0};
  EXPECT_EQ(RefusalOf({Loop()}, options),
            "--select load=LO:HI needs a normal load in every record: name its column with "
            "--normal-load-column");
  options = {};
  options.preparation.held_out = {{true, false}};
  EXPECT_THAT(RefusalOf({Loop()}, options), HasSubstr("held-out mask"));
}

}  // namespace
}  // namespace mindahl::identification::model_terms_test
