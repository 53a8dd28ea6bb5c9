// Slip forces Tc(1 + a) and Tc(1 − a) in the two senses of the motion: what tells them, and what
// does not.

#include "identification/stages.h"
#include "mindahl/identification/model_comparison.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

namespace mindahl::identification::asymmetry_test {
namespace {

using testing::PathOf;

constexpr BranchLaw kMindlin{5e7, 1.0 / 3, 60.0};
constexpr std::size_t kSamplesPerCycle = 160;
constexpr double kForceOffset = 7.0;           // [N]
constexpr double kDisplacementOffset = -3e-7;  // [m]
// a stands beside an offset of the force: the two are told apart by the virgin branch, a quarter of
// the first cycle, which costs the condition of the fit a digit or two of kNoiseFree's 1e4.
constexpr double kWithAsymmetry = 1e-6;

Record LoopOf(double asymmetry, double lambda, double cycles = 2.25,
              const BranchLaw& law = kMindlin) {
  const History displacement =
      Cycling(Wave::kSine, lambda * GrossSlipDisplacement(law), cycles, kSamplesPerCycle);
  return MakeRecord(displacement,
                    Respond(Model("mindlin-dahl"), law, displacement, {.asymmetry = asymmetry}));
}

TEST(Asymmetry, IsRecoveredWithBothOffsetsFromVirginContact) {
  for (const double alpha : {0.2, 1.0 / 3, 0.7}) {
    const BranchLaw law{5e7, alpha, 60.0};
    for (const double lambda : {0.9, 1.3, 2.5}) {
      for (const double asymmetry : {-0.6, -0.15, 0.0, 0.3, 0.75}) {
        SCOPED_TRACE(::testing::Message() << alpha << ", lambda " << lambda << ", " << asymmetry);
        const Record record =
            Shifted(LoopOf(asymmetry, lambda, 2.25, law), kDisplacementOffset, kForceOffset);
        const FitResult fit = FitOne(record, {.terms = {"asymmetry"}});
        EXPECT_EQ(fit.initial_state, InitialState::kVirgin);
        EXPECT_TRUE(Recovers(fit, law, kWithAsymmetry));
        EXPECT_NEAR(fit.Find("asymmetry")->value, asymmetry, kWithAsymmetry);
        EXPECT_NEAR(fit.Find("force_offset")->value, kForceOffset, kWithAsymmetry * law.slip_force);
      }
    }
  }
}

TEST(Asymmetry, SignIsIndependentOfForceSignAndInitialDirection) {
  Record record = LoopOf(0.25, 1.3);
  for (double& force : record.force) force = -force;  // a load cell on the other body
  const FitResult opposite = FitOne(record, {.terms = {"asymmetry"}});
  EXPECT_EQ(opposite.force_sense, -1);
  EXPECT_NEAR(opposite.Find("asymmetry")->value, 0.25, kWithAsymmetry);
  History downward = Cycling(Wave::kSine, 1.3 * GrossSlipDisplacement(kMindlin), 2.25, 160);
  for (double& x : downward) x = -x;
  const FitResult down = FitOne(
      MakeRecord(downward, Respond(Model("mindlin-dahl"), kMindlin, downward, {.asymmetry = 0.25})),
      {.terms = {"asymmetry"}});
  EXPECT_NEAR(down.Find("asymmetry")->value, 0.25, kWithAsymmetry);
}

TEST(Asymmetry, OfACycledContactFollowsFromTheKnownZeroOfTheForce) {
  const Record steady = From(LoopOf(0.25, 1.5, 3.25), 200);
  const FitResult fit = FitOne(Shifted(steady, kDisplacementOffset, kForceOffset),
                               {.terms = {"asymmetry"}, .fixed = {{"force_offset", kForceOffset}}});
  EXPECT_EQ(fit.initial_state, InitialState::kSteady);
  EXPECT_TRUE(Recovers(fit, kMindlin, kNoiseFree));
  EXPECT_NEAR(fit.Find("asymmetry")->value, 0.25, kNoiseFree);
  EXPECT_EQ(fit.Find("asymmetry")->identifiability, Identifiability::kIdentifiable);
  // Without offsets the zero is the file's.
  const FitResult literal = FitOne(
      steady, {.initial_state = InitialState::kSteady, .offsets = false, .terms = {"asymmetry"}});
  EXPECT_NEAR(literal.Find("asymmetry")->value, 0.25, kNoiseFree);
}

TEST(Asymmetry, IsRefusedForCycledContactWithFittedForceOffset) {
  // Wherever the record begins, of loops that slip and that do not: a first branch from an extreme
  // looks much like a virgin one.
  Generator generator(12);
  for (const double lambda : {0.7, 1.0, 1.5, 3.0}) {
    for (const std::size_t begin : {160U, 180U, 200U, 215U, 280U}) {
      const Record loop = WithForceNoise(From(LoopOf(0.25, lambda, 4.25), begin), 0.6, generator);
      EXPECT_THAT(RefusalOf({loop}, {.terms = {"asymmetry"}}),
                  AllOf(HasSubstr("cannot be distinguished from force_offset"),
                        HasSubstr("--fix force_offset=0"), HasSubstr("--initial-state virgin")))
          << "lambda " << lambda << " from " << begin;
    }
  }
  // Without noise a virgin contact that slips as a whole before the first sample is the same curve:
  // it tells no more.
  const Record steady = From(LoopOf(0.25, 1.5, 3.25), 200);
  const FitResult as_virgin =
      FitOne(steady, {.initial_state = InitialState::kVirgin, .terms = {"asymmetry"}});
  EXPECT_EQ(as_virgin.Find("asymmetry")->identifiability, Identifiability::kNotIdentifiable);
  // A value that is known is no question: the offset is what is left.
  const FitResult fit =
      FitOne(Shifted(steady, 0.0, kForceOffset), {.fixed = {{"asymmetry", 0.25}}});
  EXPECT_TRUE(Recovers(fit, kMindlin, kNoiseFree));
  EXPECT_NEAR(fit.Find("force_offset")->value, kForceOffset, kNoiseFree * kMindlin.slip_force);
}

TEST(Asymmetry, OfACycledContactThatNeverSlipsAsAWholeIsNotIdentified) {
  const FitOptions options{.initial_state = InitialState::kSteady,
                           .terms = {"asymmetry"},
                           .fixed = {{"force_offset", 0.0}}};
  Generator generator(3);
  const auto verdict = [&](double lambda) {
    const Record loop = WithForceNoise(From(LoopOf(0.25, lambda, 3.25), 200), 0.05, generator);
    const FitResult fit = FitOne(loop, options);
    return std::pair(fit.Find("asymmetry")->identifiability,
                     fit.FindFinding("not_identifiable", "below_slip") != nullptr);
  };
  EXPECT_EQ(verdict(0.8), std::pair(Identifiability::kNotIdentifiable, true));
  EXPECT_EQ(verdict(1.3), std::pair(Identifiability::kIdentifiable, false));
}

TEST(Asymmetry, IsIdentifiedByEveryRecordWithKnownForceZero) {
  // One slips as a whole, the other keeps a force that nobody knows.
  Generator generator(4);
  const Record slipping = WithForceNoise(From(LoopOf(0.25, 1.5, 3.25), 200), 0.05, generator);
  const Record partial = WithForceNoise(From(LoopOf(0.25, 0.8, 3.25), 200), 0.05, generator);
  const auto verdict = [&](const std::map<std::string, double>& known) {
    const FitResult fit = identification::Fit(
        std::vector<Record>{slipping, partial},
        {.initial_state = InitialState::kSteady, .terms = {"asymmetry"}, .fixed = known});
    return fit.Find("asymmetry")->identifiability;
  };
  EXPECT_EQ(verdict({{"force_offset_1", 0}}), Identifiability::kIdentifiable);
  EXPECT_EQ(verdict({{"force_offset_2", 0}}), Identifiability::kNotIdentifiable);
  EXPECT_EQ(verdict({{"force_offset_1", 0}, {"force_offset_2", 0}}),
            Identifiability::kNotIdentifiable);
}

TEST(Asymmetry, IsWhatASymmetricFitOfAVirginLoopLooksFor) {
  Generator generator(9);
  const Record record = WithForceNoise(LoopOf(0.25, 1.3), 0.6, generator);
  const FitResult symmetric = FitOne(record);
  ASSERT_NE(symmetric.adequacy.verdict, AdequacyVerdict::kAdequate);
  const auto cause =
      std::ranges::find(symmetric.adequacy.causes, "unequal_directions", &Cause::code);
  ASSERT_NE(cause, symmetric.adequacy.causes.end());
  EXPECT_EQ(cause->term, "asymmetry");
  const FitResult fit = FitOne(record, {.terms = {"asymmetry"}});
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  EXPECT_TRUE(Covers(*fit.Find("asymmetry"), 0.25));
}

}  // namespace
}  // namespace mindahl::identification::asymmetry_test
