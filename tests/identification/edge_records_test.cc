

#include <Eigen/Dense>

#include "identification/inference/estimates.h"
#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "mindahl/models/steady_loop.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Records of which next to nothing follows, and options that no loop can be under: a result that
// says so, or a refusal in words; never a broken number.
namespace mindahl::identification::edge_records_test {
namespace {

void ExpectNumbersOrNone(const FitResult& fit) {
  for (const ParameterEstimate& estimate : fit.parameters) {
    EXPECT_TRUE(std::isfinite(estimate.value)) << estimate.name;
    const double error = estimate.standard_error.value_or(0);
    EXPECT_TRUE(std::isfinite(error) && error >= 0) << estimate.name;
  }
  if (!fit.parameters.empty()) {
    EXPECT_GT(fit.law.tangential_stiffness, 0);
    EXPECT_GT(fit.law.slip_force, 0);
  }
}

TEST(EdgeRecords, SixSamplesOfWhichThreeAreOneUnderEveryLoss) {
  const Record record =
      MakeRecord({1, 1.004, 1.004, 1.004, 1.00393, 1.0039}, {-20, -20, -20, -20, 20, 20});
  for (const Loss loss : {Loss::kNone, Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
    SCOPED_TRACE(static_cast<int>(loss));
    ExpectNumbersOrNone(Fit(std::vector{record}, {.loss = loss}));
  }
}

TEST(EdgeRecords, WhiteNoiseForAForceIsInadequateWithoutACause) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    SCOPED_TRACE(seed);
    Generator generator(seed);
    Record record;
    record.displacement = Cycling(Wave::kSine, 1e-6, 3.0, 200);
    for (std::size_t i = 0; i < record.size(); ++i) record.force.push_back(Normal(generator));
    const FitResult fit = FitOne(record);
    // Noise has no sign: where it is taken for the wrong one there is not even a start.
    if (fit.FindFinding("not_converged") != nullptr) continue;
    EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kInadequate);
    EXPECT_TRUE(fit.adequacy.causes.empty());
    EXPECT_NE(fit.FindFinding("model_inadequate", "no_loop"), nullptr);
    // What would be to do if there were a loop.
    EXPECT_EQ(fit.FindFinding("bounded_below"), nullptr);
    for (const char* name : {"sigma", "alpha", "slip_force"}) {
      EXPECT_EQ(fit.Find(name)->identifiability, Identifiability::kNotIdentifiable) << name;
    }
  }
}

TEST(EdgeRecords, CoarseStepsOfTheForceAreInTheIntervals) {
  constexpr models::BranchLaw kJenkins{2e6, 0.0, 10.4};
  constexpr double kStep = 1.0;
  Record record = testing::LoopOf(kJenkins, Cycling(Wave::kTriangle, 20e-6, 4.0, 40));
  for (double& force : record.force) force = kStep * std::round(force / kStep);
  const FitResult fit = FitOne(record);
  for (const auto& [name, truth] :
       {std::pair("sigma", kJenkins.tangential_stiffness), std::pair("slip_force", 10.4)}) {
    ASSERT_TRUE(fit.Find(name)->lower95 && fit.Find(name)->upper95) << name;
    EXPECT_TRUE(Covers(*fit.Find(name), truth)) << name;
  }
}

/// A loop with a sharp knee that slips in one direction leaves Tc and the two offsets correlated. A
/// parabola at the minimum does not show how far Tc may lie from it.
TEST(EdgeRecords, SlipInOneDirectionOfASharpKneeHasNoNarrowIntervalBesideTheTruth) {
  constexpr models::BranchLaw kJenkins{1e7, 0.0, 50.0};
  constexpr double kAmplitude = 3e-6;
  for (std::uint64_t seed = 25; seed <= 32; ++seed) {
    SCOPED_TRACE(seed);
    Generator generator(seed);
    History displacement;
    for (int i = 0; i <= 240; ++i) {
      displacement.push_back(kAmplitude * (1 - std::cos(2 * std::numbers::pi * i / 80)));
    }
    Record record = testing::LoopOf(kJenkins, displacement);
    for (double& force : record.force) force += 0.05 * Normal(generator);
    const FitResult fit = FitOne(record);
    const ParameterEstimate& slip_force = *fit.Find("slip_force");
    const double upper = slip_force.upper95.value_or(HUGE_VAL);
    EXPECT_TRUE(Covers(slip_force, kJenkins.slip_force) || upper > 1.1 * slip_force.value)
        << slip_force.value << ' ' << upper;
  }
}

TEST(EdgeRecords, AsManySamplesAsFreeParameters) {
  // σ, α and Tc: at the file's zeros the contact is unloaded.
  const Record record = MakeRecord({0.0, 0.0002828427124746, 0.0004}, {0, 20, 20});
  EXPECT_THAT(RefusalOf({record}, {}), HasSubstr("3 samples are too few for 3 free parameters"));
  // Elsewhere the force has an offset too.
  const std::vector<Record> elsewhere = {
      MakeRecord({1.0, 1.0002828427124746, 1.0004}, {0, 20, 20})};
  EXPECT_THAT(RefusalOf(elsewhere, {}), HasSubstr("3 samples are too few for 4 free parameters"));
}

TEST(EdgeRecords, AForceNoiseWhoseSquareIsNoNumberIsRefused) {
  const std::vector<Record> loop = {Loop()};
  EXPECT_THAT(RefusalOf(loop, {.force_noise = 1e160}),
              HasSubstr("force_noise [N] = 1e+160 is invalid: must be below 1e100 times"));
  for (const double noise : {1e-300, 1e99}) ExpectNumbersOrNone(Fit(loop, {.force_noise = noise}));
}

TEST(EdgeRecords, ValuesFarFromTheDataAreRefusedOrLeaveNoBrokenNumber) {
  const Record record = Loop();
  const auto expect_none = [&](const FitOptions& options) {
    try {
      ExpectNumbersOrNone(FitOne(record, options));
    } catch (const InvalidArgument& error) {
      EXPECT_THAT(error.what(), HasSubstr("must "));
    }
  };
  for (const double far : {1e308, 1e150, 1e50, 1e-50, 1e-150}) {
    SCOPED_TRACE(far);
    for (const char* name : {"sigma", "slip_force", "force_offset"}) {
      SCOPED_TRACE(name);
      expect_none({.fixed = {{name, far}}});
      expect_none({.start = {{name, far}}});
      expect_none({.bounds = {{name, {1e-9, far}}}});
      expect_none({.priors = {{name, {far, 1.0}}}});
    }
    expect_none({.priors = {{"alpha", {1.0, far}}}});
  }
}

TEST(EdgeRecords, ADurationWhoseInverseIsNoNumberIsRefused) {
  for (const double step : {1e-320, 1e300}) {
    EXPECT_THAT(RefusalOf({testing::Timed(Loop(), step)}, {}), HasSubstr("half duration [s]"))
        << step;
  }
}

TEST(EdgeRecords, ARigSofterThanTheLoopIsRefusedWithTheLoopsStiffness) {
  const Record record = Loop();
  const double secant = kLaw.slip_force / testing::kReach;
  EXPECT_THAT(
      RefusalOf({record}, {.fixed = {{"rig_stiffness", 0.5 * secant}}}),
      AllOf(HasSubstr("rig_stiffness [N/m] = "), HasSubstr("the stiffness of the loop itself")));
  const double stiff = 2 * kLaw.tangential_stiffness;
  EXPECT_EQ(RefusalOf({record}, {.fixed = {{"rig_stiffness", stiff}}}), "");
  EXPECT_EQ(RefusalOf({record}, {.terms = {"rig_stiffness"}}), "");
}

// ---
// Tests that no result contradicts itself.

constexpr BranchLaw kMindlin{5e7, 1.0 / 3, 40.0};

Record NoisyLoop(const BranchLaw& law, double amplitude, double noise, std::uint64_t seed,
                 int samples_per_cycle = 200, double cycles = 2.25,
                 const InitialContact& initial = {}) {
  const History displacement = Cycling(Wave::kSine, amplitude, cycles, samples_per_cycle);
  Generator generator(seed);
  return WithForceNoise(
      MakeRecord(displacement, Respond(Model("mindlin-dahl"), law, displacement, initial)), noise,
      generator);
}

/// Expects the relations that every result must obey, whatever the record.
void ExpectNoContradiction(const FitResult& fit) {
  for (const ParameterEstimate& estimate : fit.parameters) {
    SCOPED_TRACE(estimate.name);
    if (estimate.status == ParameterStatus::kFixed) continue;
    if (estimate.identifiability == Identifiability::kIdentifiable) {
      ASSERT_TRUE(estimate.lower95 && estimate.upper95);
      EXPECT_LE(*estimate.lower95, estimate.value);
      EXPECT_GE(*estimate.upper95, estimate.value);
      EXPECT_TRUE(std::isfinite(*estimate.lower95) && std::isfinite(*estimate.upper95));
    }
  }
  for (const double correlation : fit.correlation) {
    EXPECT_FALSE(std::abs(correlation) > 1.0) << correlation;  // NaN where there is none
  }
  if (fit.FindFinding("search_limit") != nullptr) {
    EXPECT_NE(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  }
  if (fit.adequacy.verdict == AdequacyVerdict::kInadequate &&
      fit.FindFinding("model_inadequate", "no_loop") == nullptr) {
    EXPECT_GT(fit.adequacy.misfit_over_noise, 0.0);
    EXPECT_LT(fit.adequacy.p_value, 0.05);
  }
}

TEST(Contradictions, AreNotInFitsOfLoopsOfAllKinds) {
  std::uint64_t seed = 1;
  for (const double alpha : {0.0, 0.05, 1.0 / 3, 1.0}) {
    const BranchLaw law{5e7, alpha, 40.0};
    for (const double amplitude : {2e-8, 4e-7, 1.6e-6}) {
      for (const double noise : {0.01, 1.0, 20.0}) {
        SCOPED_TRACE(::testing::Message() << alpha << ", " << amplitude << ", " << noise);
        ExpectNoContradiction(FitOne(NoisyLoop(law, amplitude, noise, seed++)));
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::identification::edge_records_test
