
#include <Eigen/Dense>

#include "identification/cycle_energy.h"
#include "identification/inference/estimates.h"
#include "identification/inference/local.h"
#include "identification/intervals.h"
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

/// The same contact, read `samples` later: no time, so that a lag is in samples.
Record Delayed(const BranchLaw& law, double amplitude, int samples, int samples_per_cycle) {
  Record record = NoisyLoop(law, amplitude, 0.0, 1, samples_per_cycle, 3.25);
  Generator generator(7);
  record.force.insert(record.force.begin(), static_cast<std::size_t>(samples), 0.0);
  record.force.resize(record.displacement.size());
  return WithForceNoise(record, 0.003 * law.slip_force, generator);
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
    for (const IntervalPart& part : estimate.interval) {
      if (part.source == IntervalSource::kCarriedForce) continue;  // a limit, not a contribution
      EXPECT_LE(part.upper.value_or(HUGE_VAL), estimate.upper95.value_or(HUGE_VAL));
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

TEST(Contradictions, DelayOfATenthOfACycleIsFoundAtThirtyToAHundredSamplesACycle) {
  constexpr double kReach = 2.4e-6;  // twice gross slip
  FitOptions options;
  options.terms = {"lag"};
  for (const auto& [samples, samples_per_cycle] :
       {std::pair{3, 30}, std::pair{5, 50}, std::pair{8, 100}}) {
    SCOPED_TRACE(samples_per_cycle);
    const FitResult fit = FitOne(Delayed(kMindlin, kReach, samples, samples_per_cycle), options);
    const ParameterEstimate& lag = *fit.Find("lag");
    EXPECT_EQ(lag.status, ParameterStatus::kFree);
    EXPECT_NEAR(lag.value, samples, 0.5);
    const ParameterEstimate& sigma = *fit.Find("sigma");
    // A tenth of σ is five times what half a sample of the first branch is.
    EXPECT_NEAR(sigma.value, kMindlin.tangential_stiffness, 0.1 * kMindlin.tangential_stiffness);
    ExpectNoContradiction(fit);
  }
}

TEST(Contradictions, EnergyOfUnequalSlipForcesIsThatOfEveryCycle) {
  for (const double lambda : {0.3, 0.6, 0.9}) {
    for (const double asymmetry : {-0.6, 0.6}) {
      SCOPED_TRACE(::testing::Message() << lambda << ", " << asymmetry);
      FitOptions options;
      options.terms = {"asymmetry"};
      const double amplitude = lambda * GrossSlipDisplacement(kMindlin);
      const FitResult fit = FitOne(
          NoisyLoop(kMindlin, amplitude, 0.02, 3, 200, 4, {.asymmetry = asymmetry}), options);
      EXPECT_EQ(fit.FindFinding("energy_contradiction"), nullptr);
      EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
      const RecordFit& record = fit.records.front();
      ASSERT_EQ(record.law_energy.size(), record.facts.cycles.size());
      for (std::size_t k = 0; k < record.law_energy.size(); ++k) {
        // ∮ T dδ of n samples of noise s over a way of 4X errs by 4Xs/√n, and A by its error.
        EXPECT_NEAR(record.law_energy[k] / record.facts.cycles[k].energy, 1.0, 0.03) << k;
      }
    }
  }
}

TEST(Contradictions, SlipForceIsNotBelowTheForceThatWasCarried) {
  FitResult fit;
  fit.parameters.resize(3);
  fit.parameters[2].name = "slip_force";
  fit.parameters[2].value = 9.0;
  SetInterval(fit.parameters[2],
              {.source = IntervalSource::kOmittedTerms, .lower = 88e-6, .upper = 30.0});
  fit.records.resize(1);
  fit.records[0].facts.half_gap = 7.8;
  fit.records[0].facts.half_gap_standard_deviation = 0.2;
  fit.force_noise = 0.1;
  FitResult with_lag = fit;
  with_lag.parameters.emplace_back().name = "lag";
  fit.parameters[2] = KeepAboveCarriedForce(fit);
  EXPECT_NEAR(*fit.parameters[2].lower95, 7.8 - 2 * 0.2 - 0.1, 1e-12);
  EXPECT_EQ(fit.parameters[2].upper95, 30.0);
  EXPECT_TRUE(fit.parameters[2].IsSetBy(IntervalSource::kCarriedForce));
  // All of the interval, or a limit of an estimate, below what was carried is no answer.
  SetInterval(fit.parameters[2], {.source = IntervalSource::kParabola, .lower = 4.0, .upper = 6.0});
  fit.parameters[2].value = 5.0;
  fit.parameters[2] = KeepAboveCarriedForce(fit);
  EXPECT_FALSE(fit.parameters[2].lower95 || fit.parameters[2].upper95);
  // A lag opens the loop too.
  with_lag.parameters[2] = KeepAboveCarriedForce(with_lag);
  EXPECT_EQ(with_lag.parameters[2].lower95, 88e-6);
}

TEST(Intervals, AreTheUnionOfTheirParts) {
  ParameterEstimate estimate;
  estimate.name = "alpha";
  estimate.value = 0.5;
  Include(estimate, {.source = IntervalSource::kProfile, .lower = 0.1, .upper = 0.9});
  EXPECT_TRUE(estimate.interval.empty()) << "what is held has none";
  SetInterval(estimate, {.source = IntervalSource::kParabola, .lower = 0.4, .upper = 0.6});
  Include(estimate, {.source = IntervalSource::kOmittedTerms, .lower = 0.45, .upper = 0.8});
  EXPECT_EQ(estimate.lower95, 0.4);
  EXPECT_EQ(estimate.upper95, 0.8);
  EXPECT_TRUE(estimate.IsSetBy(IntervalSource::kParabola));
  EXPECT_TRUE(estimate.IsSetBy(IntervalSource::kOmittedTerms));
  Include(estimate, {.source = IntervalSource::kProfile, .lower = 0.5, .upper = HUGE_VAL});
  EXPECT_EQ(estimate.lower95, 0.4);
  EXPECT_FALSE(estimate.upper95) << "an end that is no number is open";
  Include(estimate, {.source = IntervalSource::kPlateau, .lower = 0.5, .upper = 0.5});
  EXPECT_FALSE(estimate.upper95) << "and stays open";
  WithdrawInterval(estimate);
  EXPECT_TRUE(!estimate.lower95 && !estimate.upper95 && estimate.interval.empty());
}

}  // namespace
}  // namespace mindahl::identification::contradictions_test
