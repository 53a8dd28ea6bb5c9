#include "support/measured.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/command_line.h"

// Measured records of other people, in place: what a good tool must notice in each
// (../shared/measured/README.md). Reference values are those of the README, found by others.
namespace mindahl {
namespace {

using nlohmann::json;
using testing::MeasuredPath;
using testing::Outcome;
using testing::RunCommand;
using Words = std::vector<std::string>;

class MeasuredRecord : public ::testing::Test {
 protected:
  json Fit(const std::string& file, Words options) {
    options.insert(options.begin(), {"fit", MeasuredPath(file), "--json", "-"});
    const Outcome outcome = RunCommand(options);
    EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
    return outcome.Json();
  }
  static bool IsAbsent(const std::string& file) {
    return !std::filesystem::exists(MeasuredPath(file));
  }
  static double Value(const json& fit, const char* parameter) {
    return fit["parameters"][parameter]["value"];
  }
};

#define SKIP_WITHOUT(file) \
  if (IsAbsent(file)) GTEST_SKIP() << "no measured record " << MeasuredPath(file)

TEST_F(MeasuredRecord, TribometerIsFittedAsByTheReference) {
  constexpr const char* kFile = "tribometer/test_data_2.txt";
  SKIP_WITHOUT(kFile);
  const json fit = Fit(kFile, {"--time-window", "20:60"});
  EXPECT_EQ(fit["input"]["force_sign"], "opposite");
  EXPECT_NEAR(Value(fit, "sigma"), 41.3e3, 1e3);
  EXPECT_LT(Value(fit, "alpha"), 0.1);
  EXPECT_NEAR(Value(fit, "slip_force"), 2.35, 0.03);
  EXPECT_NEAR(fit["residuals"]["normalized_rms"].get<double>(), 0.045, 0.003);
  EXPECT_NEAR(fit["contact"]["friction_coefficient"]["value"].get<double>(), 0.47, 0.01);
  EXPECT_NEAR(fit["loop"]["energy_per_cycle_measured"].get<double>(), 516e-6, 9e-6);
  EXPECT_NEAR(Value(fit, "force_offset"), -0.1, 0.05);
  EXPECT_NEAR(fit["loop"]["centre"].get<double>(), -0.110, 0.001);
  EXPECT_EQ(fit["loop"]["slip_regime"], "gross");
  // Residuals hang together over whole branches: the samples are far from independent.
  EXPECT_LT(fit["residuals"]["effective_samples"].get<double>(), 1000.0);
}

const Words kSealColumns = {"--displacement", "5", "--displacement-unit", "mm",
                            "--force",        "7", "--force-unit",        "N",
                            "--time",         "1", "--time-unit",         "ms"};

TEST_F(MeasuredRecord, SealsGiveTheHalfGapOfTheirForcesAndTheOffsetOfThePressure) {
  struct Seal {
    const char* file;
    double half_gap;  // [N]
    double pressure;  // [bar]
  };
  for (const Seal& seal :
       {Seal{"seals/O-ring257_3bar.csv", 8.5, 3.0}, Seal{"seals/NAP310_5bar.csv", 7.2, 5.0},
        Seal{"seals/Circle_1bar.csv", 5.6, 1.0}}) {
    SCOPED_TRACE(seal.file);
    SKIP_WITHOUT(seal.file);
    const json fit = Fit(seal.file, kSealColumns);
    EXPECT_NEAR(Value(fit, "slip_force"), seal.half_gap, 0.5);
    EXPECT_NEAR(Value(fit, "force_offset"), 50 * seal.pressure, 0.1 * 50 * seal.pressure);
    // 9.5 cycles: the backward steps of the laser make no reversal.
    EXPECT_EQ(fit["input"]["cycles"], 9);
    EXPECT_EQ(fit["input"]["reversals"], 19);
    EXPECT_GT(fit["input"]["reversal_gate"][0].get<double>(), 0.65e-3);
    EXPECT_NEAR(fit["loop"]["amplitude"].get<double>(), 20e-3, 1e-3);
  }
}

TEST_F(MeasuredRecord, GearboxThatNeverSlipsHasNoIdentifiableSlipForce) {
  constexpr const char* kFile = "cycloidal/2024-07-12__16-46-43__torqueramp__conic_4pre1.csv";
  SKIP_WITHOUT(kFile);
  const json fit = Fit(kFile, {});
  EXPECT_EQ(fit["parameters"]["slip_force"]["identifiability"], "bounded_below");
  EXPECT_EQ(fit["parameters"]["alpha"]["identifiability"], "not_identifiable");
  EXPECT_TRUE(fit["parameters"]["slip_force"]["ci95"][1].is_null());
}

TEST_F(MeasuredRecord, BandBrakeWithBacklashLeavesTheResidualThatNoModelFollows) {
  constexpr const char* kFile = "band_brake/dataset-1_0.5Hz70lbtension.csv";
  SKIP_WITHOUT(kFile);
  const json fit = Fit(kFile, {});
  EXPECT_GT(fit["residuals"]["normalized_rms"].get<double>(), 0.14);
  EXPECT_LT(fit["residuals"]["normalized_rms"].get<double>(), 0.19);
  EXPECT_LT(fit["residuals"]["durbin_watson"].get<double>(), 0.5);
}

}  // namespace
}  // namespace mindahl
