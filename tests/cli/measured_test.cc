#include "support/measured.h"

#include <filesystem>

#include "cli/command_line.h"
#include "support/prelude.h"

// Measured records of other people, in place: what a good tool must notice in each
// (../shared/measured/README.md). Reference values are those of the README, found by others.
namespace mindahl::cli::measured_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

class MeasuredRecord : public ::testing::Test {
 protected:
  /// Fits the law alone, as the references do.
  json Fit(const std::string& file, Words options) {
    options.insert(options.begin(), {"fit", MeasuredPath(file), "--json", "-"});
    const Outcome outcome = RunCommand(options);
    EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
    return outcome.Json();
  }
  static bool IsAbsent(const std::string& file) {
    return !std::filesystem::exists(MeasuredPath(file));
  }
  static bool Warns(const json& fit, const char* code) {
    return std::ranges::any_of(fit["warnings"],
                               [&](const json& warning) { return warning["code"] == code; });
  }
  /// Tc is known, and its interval contains the half gap that was measured without a model.
  static void ExpectGapWithinTc(const json& fit) {
    const json& slip_force = fit["parameters"]["slip_force"];
    EXPECT_EQ(slip_force["identifiability"], "effective");
    ASSERT_TRUE(slip_force["ci95"][0].is_number() && slip_force["ci95"][1].is_number());
    EXPECT_LE(slip_force["ci95"][0], fit["measured"]["half_gap"]["value"]);
    EXPECT_GE(slip_force["ci95"][1], fit["measured"]["half_gap"]["value"]);
  }
  static double RelativeRms(const json& fit) {
    return fit["residuals"]["rms"].get<double>() / Value(fit, "slip_force");
  }
};

#define SKIP_WITHOUT(file) \
  if (IsAbsent(file)) GTEST_SKIP() << "no measured record " << MeasuredPath(file)

TEST_F(MeasuredRecord, TribometerIsFittedAsByTheReference) {
  constexpr const char* kFile = "tribometer/test_data_2.txt";
  SKIP_WITHOUT(kFile);
  const json fit = Fit(kFile, {"--time-window", "20:60"});
  EXPECT_NEAR(Value(fit, "sigma"), 41.3e3, 1e3);
  EXPECT_LT(Value(fit, "alpha"), 0.1);
  EXPECT_NEAR(Value(fit, "slip_force"), 2.35, 0.03);
  EXPECT_NEAR(RelativeRms(fit), 0.045, 0.003);
  EXPECT_NEAR(fit["contact"]["friction_coefficient"]["value"].get<double>(), 0.47, 0.01);
  EXPECT_NEAR(fit["measured"]["energy_per_cycle"].get<double>(), 516e-6, 9e-6);
  EXPECT_NEAR(Value(fit, "force_offset"), -0.1, 0.05);
  // Residuals are autocorrelated over whole branches: the samples are far from independent.
  EXPECT_LT(fit["residuals"]["effective_samples"].get<double>(), 1000.0);
}

TEST_F(MeasuredRecord, TribometerUnderItsFullLoadIsFittedAsBetweenTwentyAndSixtySeconds) {
  constexpr const char* kFile = "tribometer/test_data_2.txt";
  SKIP_WITHOUT(kFile);
  const json fit = Fit(kFile, {"--load-window", "4.98:5.1"});
  // Rows of the file, counted by awk: 42579 in all, 2174 of them under another load.
  EXPECT_EQ(fit["input"]["samples"], 42579);
  EXPECT_EQ(fit["input"]["left_out"][0]["samples"], 2174);
  EXPECT_NEAR(Value(fit, "sigma"), 41.3e3, 1e3);
  EXPECT_LT(Value(fit, "alpha"), 0.1);
  EXPECT_NEAR(Value(fit, "slip_force"), 2.35, 0.03);
  EXPECT_NEAR(fit["contact"]["friction_coefficient"]["value"].get<double>(), 0.47, 0.01);
}

const Words kSealColumns = {"--displacement", "5 [mm]", "--force", "7 [N]", "--time", "1 [ms]"};

class MeasuredSeal : public MeasuredRecord {
 protected:
  /// @param half_gap [N], pressure [bar]
  void ExpectFit(const char* file, double half_gap, double pressure) {
    SKIP_WITHOUT(file);
    const json fit = Fit(file, kSealColumns);
    EXPECT_NEAR(Value(fit, "slip_force"), half_gap, 0.5);
    EXPECT_NEAR(Value(fit, "force_offset"), 50 * pressure, 0.1 * 50 * pressure);
    // 9.5 cycles: the backward steps of the laser make no reversal.
    EXPECT_EQ(fit["input"]["cycles"], 9);
    EXPECT_EQ(fit["input"]["reversals"], 19);
    EXPECT_NEAR(fit["measured"]["amplitude"].get<double>(), 20e-3, 1e-3);
  }
};

TEST_F(MeasuredSeal, GivesTheHalfGapOfItsForceAndTheOffsetOfThePressure) {
  ExpectFit("seals/Circle_1bar.csv", 5.6, 1.0);
}

TEST_F(MeasuredSeal, OfTwoMoreKindsGivesThem) {
  ExpectFit("seals/O-ring257_3bar.csv", 8.5, 3.0);
  ExpectFit("seals/NAP310_5bar.csv", 7.2, 5.0);
}

TEST_F(MeasuredRecord, SealsAndDampersThatSlideHaveASlipForceThatContainsTheirGap) {
  const Words seal = {"--displacement", "5 [mm]", "--force", "7 [N]", "--time", "1 [ms]"};
  const std::vector<std::pair<std::string, Words>> records = {
      {"seals/rerun_1_O-ring257_5bar.csv", seal},
      {"seals/Circle_2bar.csv", seal},
      {"mr_damper_labcontrol/ensaio1.1.csv", {"--terms", "viscous"}},
      {"mr_damper_utfsm/25mm_0.25Hz_0.5A.csv", {}}};
  for (const auto& [file, options] : records) {
    SCOPED_TRACE(file);
    SKIP_WITHOUT(file);
    ExpectGapWithinTc(Fit(file, options));
  }
}

}  // namespace
}  // namespace mindahl::cli::measured_test
