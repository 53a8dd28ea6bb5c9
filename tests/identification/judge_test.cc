#include "identification/diagnosis/adequacy.h"
#include "identification/stages.h"
#include "support/prelude.h"

// Verdicts from estimates and findings alone, by precedence.
namespace mindahl::identification::judge_test {
namespace {

ParameterEstimate Known(const char* name) {
  return {.name = name,
          .unit = "-",
          .value = 2.0,
          .standard_error = 0.1,
          .lower95 = 1.8,
          .upper95 = 2.2,
          .status = ParameterStatus::kFree};
}

struct Verdict {
  FindingCode code;
  Identifiability verdict;
};

/// What each finding says of the parameters that it names, as docs/contract.md has it.
constexpr auto kVerdicts = std::to_array<Verdict>({
    {"not_identifiable", Identifiability::kNotIdentifiable},
    {"bounded_below", Identifiability::kBoundedBelow},
    {"model_inadequate", Identifiability::kNotIdentifiable},
    {"reversals_uncertain", Identifiability::kIdentifiable},
});

TEST(Judge, VerdictsAreInTheOrderOfPrecedence) {
  using enum Identifiability;
  EXPECT_GT(kNotIdentifiable, kBoundedBelow);
  EXPECT_GT(kBoundedBelow, kEffective);
  EXPECT_GT(kEffective, kIdentifiable);
}

Identifiability JudgedWith(ParameterEstimate estimate, std::vector<Finding> findings) {
  Judge({&estimate, 1}, findings);
  return estimate.identifiability;
}

TEST(Judge, FindingSetsTheVerdictOnWhatItNamesOnly) {
  for (const auto& [code, verdict] : kVerdicts) {
    std::array estimates = {Known("sigma"), Known("alpha"), Known("slip_force")};
    const Finding finding{.code = code, .parameters = {"alpha"}};
    Judge(estimates, {&finding, 1});
    EXPECT_EQ(estimates[1].identifiability, verdict) << code.row().code;
    EXPECT_EQ(estimates[0].identifiability, Identifiability::kIdentifiable) << code.row().code;
    EXPECT_EQ(estimates[2].identifiability, Identifiability::kIdentifiable) << code.row().code;
  }
}

TEST(Judge, OfTwoFindingsTheWorseHoldsInEitherOrder) {
  for (const auto& [one, verdict_of_one] : kVerdicts) {
    for (const auto& [other, verdict_of_other] : kVerdicts) {
      const Finding first{.code = one, .parameters = {"sigma", "alpha"}};
      const Finding second{.code = other, .parameters = {"alpha"}};
      const Identifiability worse = std::max(verdict_of_one, verdict_of_other);
      EXPECT_EQ(JudgedWith(Known("alpha"), {first, second}), worse)
          << one.row().code << ", " << other.row().code;
      EXPECT_EQ(JudgedWith(Known("alpha"), {second, first}), worse)
          << one.row().code << ", " << other.row().code;
      EXPECT_EQ(JudgedWith(Known("sigma"), {second, first}), verdict_of_one) << one.row().code;
    }
  }
}

TEST(Judge, FindingWithoutParametersChangesNone) {
  for (const auto& [code, verdict] : kVerdicts) {
    EXPECT_EQ(JudgedWith(Known("alpha"), {{.code = code}}), Identifiability::kIdentifiable)
        << code.row().code;
  }
  EXPECT_EQ(JudgedWith(Known("alpha"), {{.code = "not_converged"}}),
            Identifiability::kIdentifiable);
}

TEST(Judge, FixedParameterIsIdentifiableWhateverTheFindings) {
  ParameterEstimate held = Known("alpha");
  held.status = ParameterStatus::kFixed;
  held.standard_error = held.lower95 = held.upper95 = std::nullopt;
  EXPECT_EQ(JudgedWith(held, {{.code = "not_identifiable", .parameters = {"alpha"}}}),
            Identifiability::kIdentifiable);
}

TEST(Judge, OpenIntervalIsALimitAndNoIntervalIsNothing) {
  ParameterEstimate open = Known("slip_force");
  open.upper95.reset();
  EXPECT_EQ(JudgedWith(open, {}), Identifiability::kBoundedBelow);
  EXPECT_EQ(JudgedWith(open, {{.code = "model_inadequate", .parameters = {"slip_force"}}}),
            Identifiability::kNotIdentifiable);
  EXPECT_EQ(JudgedWith(open, {{.code = "reversals_uncertain", .parameters = {"slip_force"}}}),
            Identifiability::kBoundedBelow)
      << "a finding makes nothing better";
  open.lower95.reset();
  EXPECT_EQ(JudgedWith(open, {}), Identifiability::kNotIdentifiable);
  // At a bound there is an interval and no error.
  ParameterEstimate at_bound = Known("alpha");
  at_bound.status = ParameterStatus::kAtLowerBound;
  at_bound.standard_error.reset();
  EXPECT_EQ(JudgedWith(at_bound, {}), Identifiability::kIdentifiable);
}

TEST(Judge, IntervalThatIncludesTheDiscrepancyIsEffective) {
  ParameterEstimate estimate = Known("slip_force");
  estimate.includes_discrepancy = true;
  EXPECT_EQ(JudgedWith(estimate, {}), Identifiability::kEffective);
  EXPECT_EQ(JudgedWith(estimate, {{.code = "not_identifiable", .parameters = {"slip_force"}}}),
            Identifiability::kNotIdentifiable)
      << "a wide one is no answer";
  estimate.upper95.reset();
  EXPECT_EQ(JudgedWith(estimate, {}), Identifiability::kBoundedBelow);
}

TEST(Judge, EarlierVerdictIsForgotten) {
  ParameterEstimate estimate = Known("alpha");
  estimate.identifiability = Identifiability::kNotIdentifiable;
  EXPECT_EQ(JudgedWith(estimate, {}), Identifiability::kIdentifiable);
}

// ---
// Tests the use of a fit, by the ratio of the missed force to the measured half gap.

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
  EXPECT_EQ(fit.MisfitScale(), fit.records[0].facts.amplitude);
}

TEST(Grade, WhiteNoiseIsNotMissed) {
  FitResult fit = SlidingFit();
  SetResiduals({1, 1, 1, 1, 1, 1}, fit);
  EXPECT_NEAR(MissedForce(fit), 1.0, kRounding);
  SetResiduals({1, -1, 1, -1, 1, -1}, fit);
  EXPECT_EQ(MissedForce(fit), 0.0);
  // The residuals 0, 0, 3, 0, 0, 0 have the second differences 0.5·3, −3, 0.5·3 and 0, of mean
  // square 13.5/4; the white variance is 2/3 of it, 2.25, and exceeds the mean square of 1.5.
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
    GradeUse(Thresholds(), fit);
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
  GradeUse(Thresholds(), fit);
  EXPECT_FALSE(fit.adequacy.misfit_over_half_gap);
  EXPECT_EQ(fit.adequacy.use, Use::kQuantitative);
}

TEST(Grade, LoopThatIsNotSeenIsOfNoUse) {
  FitResult fit = SlidingFit();
  SetResiduals(std::vector<double>(5, 0.1), fit);
  fit.residuals.r_squared = 0.05;
  GradeUse(Thresholds(), fit);
  EXPECT_EQ(fit.adequacy.use, Use::kNone);
}

TEST(Grade, GapIsThatAtTheMeanLoad) {
  FitResult fit = SlidingFit();
  fit.records[0].load_ratio = 2.0;
  ASSERT_TRUE(fit.MeasuredHalfGap());
  EXPECT_EQ(*fit.MeasuredHalfGap(), 4.0);
}

TEST(Intervals, StayWithinBoundsOfTheTheoryAndOfTheUserAndAreOpenBeyondThoseOfTheSearch) {
  Parameter shape{.term = &TermOf(TermId::kAlpha), .lower = 0.0, .upper = 20.0};
  EXPECT_EQ(EndsWithinBounds(shape, -0.2, 30.0).lower, 0.0);
  EXPECT_EQ(EndsWithinBounds(shape, -0.2, 19.0).upper, 19.0);
  EXPECT_FALSE(EndsWithinBounds(shape, -0.2, 30.0).upper) << "the search's own";
  shape.bounded_by_user = true;
  EXPECT_EQ(EndsWithinBounds(shape, -0.2, 30.0).upper, 20.0);
  shape.scale = -1.0;  // the value falls where θ grows
  EXPECT_EQ(EndsWithinBounds(shape, -1.0, 30.0).lower, -20.0);
  EXPECT_EQ(EndsWithinBounds(shape, -1.0, 30.0).upper, 0.0);
}

}  // namespace
}  // namespace mindahl::identification::judge_test
