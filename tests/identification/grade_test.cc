#include "identification/diagnosis/adequacy.h"
#include "identification/stages.h"
#include "support/prelude.h"

// What a fit is good for, by the force that it misses over what was measured without a model.
namespace mindahl::identification::grade_test {
namespace {

constexpr double kRounding = 1e-14;

/// T* = 10 N, half gap 8 N, energy ratio 0.8.
FitResult SlidingFit(double energy_ratio = 0.8) {
  FitResult fit = testing::MadeFit(/*peak_force=*/10.0);
  loop::LoopFacts& facts = fit.records[0].facts;
  facts.closed = true;
  facts.peak_force = 10.0;
  facts.half_gap = 8.0;
  facts.energy_ratio = energy_ratio;
  fit.adequacy.verdict = AdequacyVerdict::kDoubtful;
  fit.residuals.r_squared = 0.9;
  return fit;
}

void SetResiduals(std::vector<double> residuals, FitResult& fit) {
  double squares = 0.0;
  for (const double r : residuals) squares += r * r;
  fit.rms = std::sqrt(squares / static_cast<double>(residuals.size()));
  fit.records[0].counts.assign(residuals.size(), 1);
  fit.records[0].residual = std::move(residuals);
}

TEST(Grade, LeavesTheHalfGapWhereTcIsMoreThanAQuarterOffToEitherSide) {
  loop::LoopFacts facts = SlidingFit(/*energy_ratio=*/0.6).records[0].facts;
  EXPECT_FALSE(LeavesHalfGap(facts, 8.0, 9.9));
  EXPECT_TRUE(LeavesHalfGap(facts, 8.0, 10.1));
  EXPECT_FALSE(LeavesHalfGap(facts, 8.0, 6.5));
  EXPECT_TRUE(LeavesHalfGap(facts, 8.0, 6.3));
  EXPECT_FALSE(LeavesHalfGap(facts, 11.0, 6.3)) << "it comes nearer";
  EXPECT_TRUE(LeavesHalfGap(facts, 11.0, 4.3));
  facts.energy_ratio = 0.5;
  EXPECT_FALSE(LeavesHalfGap(facts, 8.0, 6.3)) << "the loop does not slide";
}

TEST(Grade, MisfitIsHeldAgainstWhatWasMeasured) {
  EXPECT_EQ(SlidingFit().MisfitScale(), 8.0);
  EXPECT_EQ(SlidingFit(/*energy_ratio=*/0.2).MisfitScale(), 10.0);
  FitResult fit = SlidingFit();
  fit.law.slip_force = 1e6;  // runs away
  EXPECT_EQ(fit.MisfitScale(), 8.0);
  fit.response = loop::Channel::kDisplacement;
  EXPECT_EQ(fit.MisfitScale(), fit.records[0].measures.amplitude);
}

TEST(Grade, WhiteNoiseIsNotMissed) {
  FitResult fit = SlidingFit();
  SetResiduals({1, 1, 1, 1, 1, 1}, fit);
  EXPECT_NEAR(MissedForce(fit), 1.0, kRounding);
  SetResiduals({1, -1, 1, -1, 1, -1}, fit);
  EXPECT_EQ(MissedForce(fit), 0.0);
  // Of 0, 0, 3, 0, 0, 0 the distances are 0.5·3, −3, 0.5·3 and 0: mean square 13.5/4, variance
  // 2/3 of it, 2.25, of a mean square of 1.5.
  SetResiduals({0, 0, 3, 0, 0, 0}, fit);
  EXPECT_EQ(MissedForce(fit), 0.0);
  // Twice 2 beside it: mean square (4·5 + 9)/6, distances 0, −0.5, 1, −0.5, 0 without the ends.
  SetResiduals({2, 2, 2, 3, 2, 2}, fit);
  EXPECT_NEAR(MissedForce(fit), std::sqrt(29.0 / 6 - (0.25 + 1 + 0.25) / 4 / 1.5), kRounding);
  fit.records[0].counts[3] = 0;  // no three neighbours are left with the third
  EXPECT_NEAR(MissedForce(fit), fit.rms, kRounding);
}

TEST(Grade, NoiseAndWhatARobustLossWeighsDownAreNotMissed) {
  FitResult fit = SlidingFit();
  SetResiduals({2, 2, 2, 2, 2}, fit);
  fit.adequacy.misfit = 0.5;
  EXPECT_NEAR(MissedForce(fit), 2.0, kRounding);
  fit.outliers = 1;
  EXPECT_EQ(MissedForce(fit), 0.5);
  fit.outliers = 0;
  fit.adequacy.verdict = AdequacyVerdict::kAdequate;
  EXPECT_EQ(MissedForce(fit), 0.5);
}

TEST(Grade, UseFollowsTheMisfitOverTheHalfGap) {
  struct Case {
    double missed;
    Use use;
  };
  for (const auto& [missed, use] : {Case{0.39, Use::kQuantitative}, Case{0.41, Use::kIndicative},
                                    Case{1.19, Use::kIndicative}, Case{1.21, Use::kNone}}) {
    FitResult fit = SlidingFit();
    SetResiduals(std::vector<double>(5, missed), fit);
    fit.adequacy = GradeUse(Thresholds(), fit);
    EXPECT_EQ(fit.adequacy.use, use) << missed;
    EXPECT_NEAR(fit.adequacy.misfit, missed, kRounding);
    ASSERT_TRUE(fit.adequacy.misfit_over_half_gap);
    EXPECT_NEAR(*fit.adequacy.misfit_over_half_gap, missed / 8, kRounding);
  }
}

TEST(Grade, WithoutAGapUseIsJudgedByTheLargestForce) {
  FitResult fit = SlidingFit();
  fit.records[0].facts.half_gap = -0.3;
  SetResiduals(std::vector<double>(5, 0.49), fit);
  fit.adequacy = GradeUse(Thresholds(), fit);
  EXPECT_FALSE(fit.adequacy.misfit_over_half_gap);
  EXPECT_EQ(fit.adequacy.use, Use::kQuantitative);
}

TEST(Grade, LoopThatIsNotSeenIsOfNoUse) {
  FitResult fit = SlidingFit();
  SetResiduals(std::vector<double>(5, 0.1), fit);
  fit.residuals.r_squared = 0.05;
  fit.adequacy = GradeUse(Thresholds(), fit);
  EXPECT_EQ(fit.adequacy.use, Use::kNone);
}

TEST(Grade, GapIsThatAtTheMeanLoad) {
  FitResult fit = SlidingFit();
  fit.records[0].load_ratio = 2.0;
  ASSERT_TRUE(fit.MeasuredHalfGap());
  EXPECT_EQ(*fit.MeasuredHalfGap(), 4.0);
}

}  // namespace
}  // namespace mindahl::identification::grade_test
