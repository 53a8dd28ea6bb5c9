#include <Eigen/Dense>

#include "identification/inference/estimates.h"
#include "identification/inference/local.h"
#include "identification/stages.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

// What a fit may not say at once.
namespace mindahl::identification::contradictions_test {
namespace {

using namespace loop;
using namespace models;

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

/// What must hold of every result, whatever the record.
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
      fit.FindFinding("loop_not_seen") == nullptr) {
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

TEST(Intervals, AreTheUnionOfTheirParts) {
  ParameterEstimate estimate;
  estimate.name = "alpha";
  estimate.value = 0.5;
  Include(estimate, {.lower = 0.1, .upper = 0.9});
  EXPECT_FALSE(estimate.lower95 || estimate.upper95) << "what is held has none";
  SetInterval(estimate, {.lower = 0.4, .upper = 0.6});
  Include(estimate, {.lower = 0.45, .upper = 0.8});
  EXPECT_EQ(estimate.lower95, 0.4);
  EXPECT_EQ(estimate.upper95, 0.8);
  Include(estimate, {.lower = 0.5, .upper = HUGE_VAL});
  EXPECT_EQ(estimate.lower95, 0.4);
  EXPECT_FALSE(estimate.upper95) << "an end that is no number is open";
  Include(estimate, {.lower = 0.5, .upper = 0.5});
  EXPECT_FALSE(estimate.upper95) << "and stays open";
  WithdrawInterval(estimate);
  EXPECT_FALSE(estimate.lower95 || estimate.upper95);
}

}  // namespace
}  // namespace mindahl::identification::contradictions_test
