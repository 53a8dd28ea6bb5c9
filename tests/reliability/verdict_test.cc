#include "verdict.h"

#include "mindahl/identification/fit.h"
#include "support/prelude.h"

namespace mindahl::reliability::verdict_test {
namespace {

using identification::Finding;
using identification::FitResult;
using identification::Identifiability;
using identification::ParameterStatus;
using identification::Severity;

constexpr Range kTruth = {100.0, 100.0};

/// A converged fit that calls its only parameter, sigma, identifiable.
FitResult FitOf(double value, double half_width) {
  FitResult fit;
  fit.converged = true;
  fit.parameters.push_back({.name = "sigma",
                            .unit = "N/m",
                            .value = value,
                            .standard_error = {},
                            .lower95 = value - half_width,
                            .upper95 = value + half_width,
                            .status = ParameterStatus::kFree,
                            .identifiability = Identifiability::kIdentifiable});
  return fit;
}

Outcome OutcomeOf(const FitResult& fit) { return Judge(fit, {.sigma = kTruth}).outcome; }

TEST(Verdict, IsSilentOnlyWhereTheTruthIsFarOffWithoutAWarning) {
  EXPECT_EQ(OutcomeOf(FitOf(105.0, 6.0)), Outcome::kRight);
  FitResult fit = FitOf(105.0, 1.0);
  EXPECT_EQ(OutcomeOf(fit), Outcome::kSilent);
  fit.findings.push_back({.code = "glitches_left_out", .severity = Severity::kNote});
  EXPECT_EQ(OutcomeOf(fit), Outcome::kSilent) << "a note is no warning";
  fit.findings.push_back({.code = "reversals_uncertain"});
  EXPECT_EQ(OutcomeOf(fit), Outcome::kWarned);
}

TEST(Verdict, NeedsBothTwoHalfWidthsAndTwoPerCentToCallATruthFarOff) {
  EXPECT_EQ(OutcomeOf(FitOf(101.9, 0.1)), Outcome::kRight);
  EXPECT_EQ(OutcomeOf(FitOf(120.0, 10.1)), Outcome::kRight);
  EXPECT_EQ(OutcomeOf(FitOf(120.0, 9.9)), Outcome::kSilent);
}

TEST(Verdict, IsUndecidedWhereTheParameterIsNotIdentifiableOrTheFitFailed) {
  FitResult fit = FitOf(200.0, 1.0);
  fit.parameters.front().identifiability = Identifiability::kBoundedBelow;
  EXPECT_EQ(OutcomeOf(fit), Outcome::kUndecided);
  fit = FitOf(200.0, 1.0);
  fit.converged = false;
  EXPECT_EQ(OutcomeOf(fit), Outcome::kUndecided);
  EXPECT_EQ(OutcomeOf(FitResult{}), Outcome::kUndecided);
  EXPECT_EQ(Judge(FitOf(200.0, 1.0), {}).outcome, Outcome::kRight) << "without a truth";
}

TEST(Verdict, TakesAnyValueBetweenTheEndsOfARange) {
  const Expected expected{.sigma = Range{100.0, 150.0}};
  EXPECT_EQ(Judge(FitOf(140.0, 0.1), expected).outcome, Outcome::kRight);
  EXPECT_EQ(Judge(FitOf(160.0, 0.1), expected).outcome, Outcome::kSilent);
}

TEST(Verdict, TakesTheEstimateForTheEndOfAnOpenInterval) {
  FitResult fit = FitOf(100.0, 1.0);
  fit.parameters.front().lower95.reset();
  EXPECT_EQ(OutcomeOf(fit), Outcome::kRight);
  EXPECT_EQ(Judge(fit, {.sigma = kTruth}).misses, 0U);
}

TEST(Verdict, CallsALowerLimitAboveTheTruthFalse) {
  FitResult fit = FitOf(200.0, 95.0);  // from 105
  EXPECT_FALSE(Judge(fit, {.sigma = kTruth}).false_limit);
  fit.parameters.front().identifiability = Identifiability::kBoundedBelow;
  EXPECT_TRUE(Judge(fit, {.sigma = kTruth}).false_limit);
  EXPECT_FALSE(Judge(fit, {.sigma = Range{100.0, 104.0}}).false_limit);
}

TEST(Verdict, CountsIntervalsAndThoseThatMiss) {
  const Judgement near = Judge(FitOf(101.0, 0.9), {.sigma = kTruth});
  EXPECT_EQ(near.intervals, 1U);
  EXPECT_EQ(near.misses, 1U);
  EXPECT_EQ(near.outcome, Outcome::kRight);
  EXPECT_EQ(Judge(FitOf(101.0, 1.1), {.sigma = kTruth}).misses, 0U);
}

TEST(Verdict, AlarmsAtMoreThanWhatARecordLeavesOpen) {
  FitResult fit = FitOf(100.0, 1.0);
  EXPECT_FALSE(CautionOf(fit).alarms);
  fit.findings.push_back({.code = "slip_force_bounded_below"});
  EXPECT_TRUE(CautionOf(fit).warns);
  EXPECT_FALSE(CautionOf(fit).alarms);
  fit.findings.push_back({.code = "reversals_uncertain"});
  EXPECT_TRUE(CautionOf(fit).alarms);
}

}  // namespace
}  // namespace mindahl::reliability::verdict_test
