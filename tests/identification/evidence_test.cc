

#include "core/probability.h"
#include "identification/inference/noise.h"
#include "identification/problem/scaled_records.h"
#include "identification/stages.h"
#include "support/prelude.h"

// The one comparison of fits, by hand.
namespace mindahl::identification::evidence_test {
namespace {

constexpr double kRounding = 1e-13;  // of numbers up to a hundred

TEST(Evidence, LikelihoodRatioIsThatOfTheEffectiveSamples) {
  // n_eff·ln(SS₀/SS₁), whatever the samples' number.
  EXPECT_NEAR(Evidence(100, 40.0).LikelihoodRatio(3.0, 2.0), 40 * std::log(1.5), kRounding);
  EXPECT_NEAR(Evidence(50, 40.0).LikelihoodRatio(3.0, 2.0), 40 * std::log(1.5), kRounding);
  EXPECT_LT(Evidence(100, 40.0).LikelihoodRatio(2.0, 3.0), 0.0) << "the larger sum loses";
}

TEST(Evidence, RoundingErrorsSayNothing) {
  const Evidence evidence(100, 40.0);
  const double floor = 100 * kRoundingRms * kRoundingRms;
  EXPECT_EQ(evidence.LikelihoodRatio(floor / 2, 0.0), 0.0);
  EXPECT_NEAR(evidence.LikelihoodRatio(4 * floor, floor / 8), 40 * std::log(4.0), 1e-10);
  EXPECT_EQ(evidence.Aicc(floor / 2, 3), evidence.Aicc(0.0, 3));
  EXPECT_LT(evidence.Aicc(floor, 3), evidence.Aicc(2 * floor, 3));
}

TEST(Evidence, FStatisticScalesWithFractionOfEffectiveSamples) {
  // (3 − 2)/0.5·40/100
  EXPECT_NEAR(Evidence(100, 40.0).FStatistic(3.0, 2.0, 0.5), 0.8, kRounding);
  EXPECT_EQ(Evidence(100, 40.0).FStatistic(2.0, 3.0, 0.5), 0.0) << "a fit that is better by chance";
}

TEST(Evidence, AiccHasTheSmallSampleTermOfAllSamplesAndTheVarianceForAParameter) {
  // k = 3 + 1: 8·ln(5/20) + 2·4 + 2·4·5/(20 − 4 − 1)
  EXPECT_NEAR(Evidence(20, 8.0).Aicc(5.0, 3), 8 * std::log(0.25) + 8 + 40.0 / 15, kRounding);
  // Nothing is divided by less than one.
  EXPECT_NEAR(Evidence(5, 5.0).Aicc(5.0, 4), 10 + 60, kRounding);
}

TEST(Evidence, OfANoiseIsThatOfItsEffectiveSamples) {
  Noise noise = testing::KnownNoise(1.0, 100);
  noise.autocorrelation = testing::FirstOrder(0.5);
  noise.repeating = 2.0;
  // 1 + 2Σ0.25^k = 5/3
  EXPECT_NEAR(Evidence(noise).LikelihoodRatio(std::exp(1.0), 1.0), 100 / (2 * 5.0 / 3), 1e-9);
}

TEST(Noise, DegreesOfFreedomAreEffectiveSamplesLessParameters) {
  Noise noise = testing::KnownNoise(1.0, 1000);
  EXPECT_GE(noise.degrees_of_freedom(5), 1e5) << "known is known";
  noise.is_known = false;
  EXPECT_EQ(noise.degrees_of_freedom(5), 995.0);
  noise.autocorrelation = testing::FirstOrder(0.95);
  const double share = (1 + 0.95 * 0.95) / (1 - 0.95 * 0.95);
  EXPECT_NEAR(noise.effective_samples(), 1000 / share, 1e-6 * 1000 / share);
  EXPECT_NEAR(noise.degrees_of_freedom(5), 1000 / share - 5, 1e-4);
  noise.repeating = 4.0;
  EXPECT_NEAR(noise.degrees_of_freedom(5), 1000 / share / 4 - 5, 1e-4);
  noise.repeating = 1000.0;
  EXPECT_EQ(noise.effective_samples(), 1.0);
  EXPECT_EQ(noise.degrees_of_freedom(5), 1.0);
}

TEST(Distributions, AreThoseOfClosedForms) {
  // F(1, ν) is Student's t squared. P(|t| > x) = 1 − 2/π·arctan x at ν = 1, 1 − x/√(2 + x²) at 2.
  for (const double f : {0.1, 1.0, 3.84, 50.0}) {
    EXPECT_NEAR(PValueOfF(f, 1, 1.0), 1 - 2 / std::acos(-1.0) * std::atan(std::sqrt(f)), kRounding);
    EXPECT_NEAR(PValueOfF(f, 1, 2.0), 1 - std::sqrt(f / (2 + f)), kRounding);
  }
  EXPECT_EQ(PValueOfF(0.0, 1, 7.0), 1.0);
  EXPECT_NEAR(StudentQuantile(1.0, 0.95), std::tan(0.475 * std::acos(-1.0)), 1e-11);
  EXPECT_NEAR(StudentQuantile(2.0, 0.95), 0.95 * std::sqrt(2 / (1 - 0.95 * 0.95)), 1e-11);
  EXPECT_NEAR(StudentQuantile(1.0, 0.95), std::tan(0.475 * std::acos(-1.0)), 1e-11)
      << "asked for again after another";
  // Half a normal law within q: P(|z| < q) = 95 %.
  EXPECT_NEAR(std::erf(kNormalQuantile95 / std::sqrt(2.0)), 0.95, kRounding);
}

}  // namespace
}  // namespace mindahl::identification::evidence_test
