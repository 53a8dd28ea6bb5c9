#include "support/measured.h"

#include <filesystem>

#include "cli/command_line.h"

// Measured records of other people, in place: what a good tool must notice in each
// (../shared/measured/README.md). Reference values are those of the README, found by others.
namespace mindahl::cli::measured_test {
namespace {

#define SKIP_WITHOUT(file)                          \
  if (!std::filesystem::exists(MeasuredPath(file))) \
  GTEST_SKIP() << "no measured record " << MeasuredPath(file)

const Words kSealColumns = {"--displacement", "5 [mm]", "--force", "7 [N]", "--time", "1 [ms]"};

TEST(MeasuredRecord, OfATribometerIsFittedAsByTheReference) {
  constexpr const char* kFile = "tribometer/test_data_2.txt";
  SKIP_WITHOUT(kFile);
  const json fit = JsonOf("fit " + MeasuredPath(kFile) + " --time-window 20:60");
  EXPECT_NEAR(Value(fit, "sigma"), 41.3e3, 1e3);
  EXPECT_LT(Value(fit, "alpha"), 0.1);
  EXPECT_NEAR(Value(fit, "slip_force"), 2.35, 0.03);
  EXPECT_NEAR(fit["residuals"]["rms"].get<double>() / Value(fit, "slip_force"), 0.045, 0.003);
  EXPECT_NEAR(fit["contact"]["friction_coefficient"]["value"].get<double>(), 0.47, 0.01);
  EXPECT_NEAR(fit["measured"]["energy_per_cycle"].get<double>(), 516e-6, 9e-6);
  EXPECT_NEAR(Value(fit, "force_offset"), -0.1, 0.05);
  // Residuals are autocorrelated over whole branches: the samples are far from independent.
  EXPECT_LT(fit["residuals"]["effective_samples"].get<double>(), 1000.0);
}

TEST(MeasuredRecord, OfASealGivesTheHalfGapOfItsForceAndTheOffsetOfThePressure) {
  constexpr const char* kFile = "seals/Circle_1bar.csv";
  SKIP_WITHOUT(kFile);
  const json fit = JsonOf(("fit " + MeasuredPath(kFile)) + kSealColumns);
  EXPECT_NEAR(Value(fit, "slip_force"), 5.6, 0.5);
  EXPECT_NEAR(Value(fit, "force_offset"), 50, 5);  // [N] of 1 bar
  // 9.5 cycles: the backward steps of the laser make no reversal.
  EXPECT_EQ(fit["input"]["cycles"], 9);
  EXPECT_EQ(fit["input"]["reversals"], 19);
  EXPECT_NEAR(fit["measured"]["amplitude"].get<double>(), 20e-3, 1e-3);
}

TEST(MeasuredRecord, OfASealOrADamperThatSlidesHasASlipForceThatContainsItsGap) {
  const std::vector<std::pair<std::string, Words>> records = {
      {"seals/rerun_1_O-ring257_5bar.csv", kSealColumns},
      {"seals/Circle_2bar.csv", kSealColumns},
      {"mr_damper_labcontrol/ensaio1.1.csv", {}},
      {"mr_damper_utfsm/25mm_0.25Hz_0.5A.csv", {}}};
  for (const auto& [file, options] : records) {
    SCOPED_TRACE(file);
    SKIP_WITHOUT(file);
    const json fit = JsonOf(("fit " + MeasuredPath(file)) + options);
    const json& slip_force = fit["parameters"]["slip_force"];
    EXPECT_EQ(slip_force["identifiability"], "effective");
    ASSERT_TRUE(slip_force["ci95"][0].is_number() && slip_force["ci95"][1].is_number());
    EXPECT_LE(slip_force["ci95"][0], fit["measured"]["half_gap"]["value"]);
    EXPECT_GE(slip_force["ci95"][1], fit["measured"]["half_gap"]["value"]);
  }
}

}  // namespace
}  // namespace mindahl::cli::measured_test
