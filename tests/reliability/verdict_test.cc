#include "verdict.h"

#include <set>

#include "kind.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"
#include "other_laws.h"
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
  fit.findings.push_back({.code = "no_closed_cycle", .severity = Severity::kNote});
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
  fit.findings.push_back({.code = "bounded_below"});
  EXPECT_TRUE(CautionOf(fit).warns);
  EXPECT_FALSE(CautionOf(fit).alarms);
  fit.findings.push_back({.code = "reversals_uncertain"});
  EXPECT_TRUE(CautionOf(fit).alarms);
}

// ---

constexpr std::uint64_t kSeed = 7;

TEST(Kinds, MakeConsistentRecordsAndAskForSomethingThatIsPossible) {
  std::set<std::string_view> names;
  for (const Kind& kind : Kinds()) {
    SCOPED_TRACE(kind.name);
    EXPECT_TRUE(names.insert(kind.name).second);
    for (std::size_t level = 0; level < kLevels; ++level) {
      const Loop loop = MakeLoop(kind, level, kSeed);
      EXPECT_GE(loop.record.size(), 6U);
      EXPECT_NO_THROW(loop::Validate(loop.record)) << "level " << level + 1;
    }
    const Expected expected = MakeLoop(kind, 0, kSeed).expected;
    EXPECT_TRUE(expected.sigma || expected.slip_force);
    for (const auto& truth : {expected.sigma, expected.alpha, expected.slip_force}) {
      EXPECT_TRUE(!truth || truth->lowest <= truth->highest);
    }
  }
}

TEST(Kinds, MakeTheSameLoopOfTheSameSeedAndAnotherOfAnother) {
  for (const Kind& kind : Kinds()) {
    SCOPED_TRACE(kind.name);
    const loop::Record record = MakeLoop(kind, 1, kSeed).record;
    EXPECT_EQ(MakeLoop(kind, 1, kSeed).record.force, record.force);
    EXPECT_NE(MakeLoop(kind, 1, kSeed + 1).record.force, record.force);
    EXPECT_NE(MakeLoop(kind, 2, kSeed).record.force, record.force);
  }
}

TEST(Kinds, OfEveryFamilyAreInBothHalves) {
  for (const auto family : {NoiseKinds, ChannelKinds, LoggerKinds, RigKinds, ContactKinds,
                            LoadKinds, SamplingKinds, ExcitationKinds}) {
    const std::vector<Kind> kinds = family();
    for (const Half half : {Half::kDevelopment, Half::kHeldOut}) {
      EXPECT_NE(std::ranges::find(kinds, half, &Kind::half), kinds.end()) << kinds.front().name;
    }
  }
}

// ---
// Loops of other laws than the fitted one: what is effective contains what is true of them.

constexpr std::size_t kLoops = 12;
constexpr std::uint64_t kFirstSeed = 1;

TEST(Effective, SlipForceContainsThePlateauAndStiffnessThatAfterAReversal) {
  Effective slip_force;
  Effective stiffness;
  for (const OtherLaw& law : OtherLaws()) {
    SCOPED_TRACE(law.name);
    const EffectiveTally tally = Measure(law, kLoops, kFirstSeed);
    EXPECT_LE(tally.slip_force.narrow, 1U);
    slip_force.loops += tally.slip_force.loops;
    for (const auto& [sum, of_law] :
         {std::pair{&slip_force, &tally.slip_force}, {&stiffness, &tally.stiffness}}) {
      sum->given += of_law->given;
      sum->held += of_law->held;
    }
  }
  // All laws slide, most of the way from one plateau to the other; of 60 fits
  // that are not adequate B(60, 0.95) is below 51 with a probability of 0.1 %.
  EXPECT_GE(slip_force.loops, 5 * kLoops);
  EXPECT_GE(20 * slip_force.given, 17 * slip_force.loops);
  EXPECT_GE(20 * slip_force.held, 17 * slip_force.given);
  EXPECT_GE(stiffness.given, 2 * kLoops)
      << "some laws have a knee that Masing's with one exponent follows";
  EXPECT_GE(20 * stiffness.held, 17 * stiffness.given);
}

TEST(Effective, EveryLawHasAPlateauAndMostAStiffness) {
  std::size_t stiff = 0;
  for (const OtherLaw& law : OtherLaws()) {
    Draws draws(kFirstSeed);
    const OtherLoop loop = law.make(draws);
    EXPECT_GT(loop.plateau, 0.0) << law.name;
    if (!loop.stiffness) continue;
    ++stiff;
    EXPECT_GT(loop.stiffness->lowest, 0.0) << law.name;
    EXPECT_LE(loop.stiffness->lowest, loop.stiffness->highest) << law.name;
  }
  EXPECT_EQ(stiff, OtherLaws().size() - 2) << "all but those of which the force stands or jumps";
}

}  // namespace
}  // namespace mindahl::reliability::verdict_test
