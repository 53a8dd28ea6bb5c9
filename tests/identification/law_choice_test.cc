#include "identification/inference/profile.h"
#include "identification/stages.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

// Which of the two laws a record is of.
namespace mindahl::identification::law_choice_test {
namespace {

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kGrossSlip = 1.5e-6;  // [m]
constexpr int kPerCycle = 200;
constexpr double kNoise = 0.2;  // [N], 0.5 % of Tc

/// A virgin contact of a law, cycled.
Record Virgin(const char* model, double amplitude = 0.8 * kGrossSlip, double cycles = 2.5) {
  const History displacement = Cycling(Wave::kSine, amplitude, cycles, kPerCycle);
  return MakeRecord(displacement, Respond(Model(model), kMindlin, displacement));
}

/// From the first extreme on: a steady loop of Masing's law.
Record Steady(double amplitude = 0.8 * kGrossSlip) {
  return From(Virgin("mindlin-dahl", amplitude), kPerCycle / 4);
}

/// Two amplitudes, one after the other, from the first extreme on.
Record TwoAmplitudes(const char* model, double first, double second) {
  History displacement = Cycling(Wave::kSine, first, 2.25, kPerCycle);
  for (const double x : Cycling(Wave::kSine, second, 2.25, kPerCycle)) {
    displacement.push_back(x);
  }
  Record record = MakeRecord(displacement, Respond(Model(model), kMindlin, displacement));
  return From(record, kPerCycle / 4);
}

/// Six cycles of Masing's law with an amplitude that grows by a fraction, in all.
Record Growing(double fraction) {
  History displacement = Cycling(Wave::kSine, 1.3 * kGrossSlip, 6.0, kPerCycle);
  const auto samples = static_cast<double>(displacement.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    displacement[i] *= 1 + fraction * static_cast<double>(i) / samples;
  }
  return MakeRecord(displacement, Respond(Model("mindlin-dahl"), kMindlin, displacement));
}

Record Noisy(const Record& record, std::uint64_t seed = 7) {
  Generator generator(seed);
  return WithForceNoise(record, kNoise, generator);
}

TEST(LawChoice, OfASteadyLoopOfOneAmplitudeIsUndecidedWithBothSetsOfNumbers) {
  for (const double amplitude : {0.8 * kGrossSlip, 2 * kGrossSlip}) {
    const FitResult fit = FitOne(Noisy(Steady(amplitude)));
    ASSERT_TRUE(fit.law_choice);
    EXPECT_FALSE(fit.law_choice->decided());
    EXPECT_EQ(fit.law_choice->preferred, nullptr);
    EXPECT_FALSE(fit.law_choice->delta_aicc) << "there is nothing to compare";
    EXPECT_EQ(fit.law_choice->alternative->name, "dahl");
    EXPECT_LE(WorstError(fit.law_choice->law, DahlEquivalent(fit.law, amplitude)), 1e-4);
    const Finding* finding = fit.FindFinding("other_law", "undecided");
    ASSERT_NE(finding, nullptr);
    EXPECT_EQ(finding->severity, Severity::kNote);
    // By its own law each parameter is as well known as before.
    EXPECT_EQ(fit.Find("sigma")->identifiability, Identifiability::kIdentifiable);
  }
}

TEST(LawChoice, OfASteadyLoopFittedByDahlsLawGivesTheContactByMasings) {
  const FitResult fit = FitOne(Steady(), OfModel("dahl"));
  ASSERT_TRUE(fit.law_choice);
  EXPECT_FALSE(fit.law_choice->decided());
  EXPECT_EQ(fit.law_choice->alternative->name, "mindlin-dahl");
  EXPECT_LE(WorstError(fit.law, DahlEquivalent(kMindlin, 0.8 * kGrossSlip)), kNoiseFree);
  EXPECT_LE(WorstError(fit.law_choice->law, kMindlin), kNoiseFree);
}

/// A large exponent looks like slip at two thirds of Tc: held at the largest force, no law would be
/// compared.
TEST(LawChoice, IsMadeBeforeTheSlipForceIsHeldAtTheLargestForce) {
  const BranchLaw law{4e7, 2.45, 40.0};
  const History displacement = Cycling(Wave::kSine, 1.16 * kGrossSlip, 4.0, 2 * kPerCycle);
  const Record record = MakeRecord(displacement, Respond(Model("dahl"), law, displacement));
  const FitResult fit = FitOne(Noisy(record));
  ASSERT_TRUE(fit.law_choice && fit.law_choice->decided());
  EXPECT_EQ(fit.law_choice->preferred->name, "dahl");
  EXPECT_LE(fit.WidestRecord().facts.peak_force, 0.8 * law.slip_force);
}

TEST(LawChoice, IsMadeByAVirginBranch) {
  const FitResult fit = FitOne(Noisy(Virgin("mindlin-dahl")));
  ASSERT_TRUE(fit.law_choice);
  EXPECT_TRUE(fit.law_choice->decided());
  EXPECT_EQ(fit.law_choice->preferred->name, "mindlin-dahl");
  EXPECT_GT(*fit.law_choice->delta_aicc, 100.0);
  EXPECT_EQ(fit.FindFinding("other_law", "undecided"), nullptr);
  EXPECT_EQ(fit.FindFinding("other_law", "better"), nullptr);
}

TEST(LawChoice, ByAVirginBranchOfDahlsLawSpeaksAgainstMasings) {
  const Record record = Noisy(Virgin("dahl"));
  const FitResult masing = FitOne(record);
  ASSERT_TRUE(masing.law_choice);
  EXPECT_TRUE(masing.law_choice->decided());
  EXPECT_EQ(masing.law_choice->preferred, masing.law_choice->alternative);
  EXPECT_LT(*masing.law_choice->delta_aicc, -100.0);
  const Finding* finding = masing.FindFinding("other_law", "better");
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->severity, Severity::kWarning);
  // A good ten standard errors of such a loop.
  EXPECT_LE(WorstError(masing.law_choice->law, kMindlin), 0.05);

  const FitResult dahl = FitOne(record, OfModel("dahl"));
  ASSERT_TRUE(dahl.law_choice);
  EXPECT_EQ(dahl.law_choice->preferred->name, "dahl");
  EXPECT_EQ(dahl.FindFinding("other_law", "better"), nullptr);
}

TEST(LawChoice, IsMadeForDahlsLawWhereTheFirstRowIsMissing) {
  for (const double knees : {3.0, 5.0}) {
    const double amplitude = knees * kMindlin.slip_force / kMindlin.tangential_stiffness;
    const FitResult fit = FitOne(Noisy(From(Virgin("dahl", amplitude, 3.0), 1)));
    ASSERT_TRUE(fit.law_choice);
    EXPECT_TRUE(fit.prefers_other_law()) << knees;
  }
}

TEST(LawChoice, IsNotMadeForDahlsLawByADrift) {
  for (const double amplitude : {0.32, 0.54}) {
    Record record = Virgin("mindlin-dahl", amplitude * kGrossSlip, 3.25);
    const auto samples = static_cast<double>(record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
      record.force[i] += 0.03 * kMindlin.slip_force * static_cast<double>(i) / samples;
    }
    Generator generator(7);
    const FitResult fit = FitOne(WithForceNoise(record, 0.02, generator));
    EXPECT_FALSE(fit.law_choice && fit.law_choice->prefers_alternative()) << amplitude;
  }
}

TEST(LawChoice, IsNotMadeByTheStepsOfAnEncoder) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    Record record = From(Noisy(Virgin("mindlin-dahl", 0.8 * kGrossSlip, 5.0), seed), kPerCycle / 8);
    record.displacement = testing::Quantised(record.displacement, 0.8 * kGrossSlip / 15);
    const FitResult fit = FitOne(record);
    EXPECT_FALSE(fit.law_choice && fit.law_choice->prefers_alternative()) << seed;
  }
}

TEST(LawChoice, IsNotMadeByReadingsOfFewSteps) {
  for (const char* model : {"mindlin-dahl", "dahl"}) {
    for (const double steps : {3.5, 12.0, 25.0}) {
      constexpr double kAmplitude = 2 * kGrossSlip;
      Record record = Noisy(Virgin(model, kAmplitude, 4.0));
      record.displacement = testing::Quantised(record.displacement, kAmplitude / steps);
      const FitResult fit = FitOne(record);
      ASSERT_TRUE(fit.law_choice) << model << steps;
      EXPECT_EQ(fit.law_choice->decided(), steps > 20) << model << steps;
    }
  }
}

TEST(LawChoice, IsNotMadeForDahlsLawByThePastOfAnExcerpt) {
  // An amplitude that grows by 2 %, from the middle of a stroke on.
  const Record whole = Growing(0.02);
  for (const std::size_t begin : {kPerCycle / 8, 3 * kPerCycle / 8, 7 * kPerCycle / 8}) {
    const FitResult fit = FitOne(Noisy(From(whole, kPerCycle + begin)));
    ASSERT_TRUE(fit.law_choice);
    EXPECT_FALSE(fit.law_choice->prefers_alternative()) << begin;
  }
}

TEST(LawChoice, IsNotMadeByALoopThatIsCutWhereItsForceIsZero) {
  // There Dahl's contact is unloaded. The first stroke of Masing's began at a turn that is not
  // recorded, 3 % nearer than the later ones: it is left out.
  const Record whole = Growing(0.1);
  std::size_t zero = 7 * kPerCycle / 4;
  while (whole.force[zero] < 0) ++zero;
  const FitResult fit = FitOne(Noisy(From(whole, zero)));
  EXPECT_EQ(fit.model->name, "mindlin-dahl");
  ASSERT_TRUE(fit.law_choice);
  EXPECT_FALSE(fit.law_choice->decided());
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  EXPECT_NEAR(fit.law.tangential_stiffness / kMindlin.tangential_stiffness, 1.0, 0.01);
  EXPECT_EQ(fit.records[0].first_stroke, fit.records[0].reversals.front());
  EXPECT_EQ(fit.records[0].counts.front(), 0);
  EXPECT_EQ(fit.records[0].counts[fit.records[0].reversals.front()], 1);
  // Half a cycle, which no whole stroke follows.
  Record part = Noisy(From(whole, zero));
  for (auto* const column : {&part.time, &part.displacement, &part.force}) {
    column->resize(std::min<std::size_t>(column->size(), kPerCycle / 2));
  }
  const FitResult half = FitOne(part);
  EXPECT_FALSE(half.law_choice && half.law_choice->decided());
  EXPECT_FALSE(half.Find("alpha")->is_known());
}

TEST(FirstStroke, OfAnUnloadedContactIsKeptThoughItDoesNotFit) {
  // Short of slip the next stroke passes near the file's zeros, where the record begins.
  Record record = Virgin("mindlin-dahl", 0.5 * kGrossSlip, 3.0);
  for (int i = 0; i < kPerCycle / 4; ++i) record.force[i] *= 1.05;
  const FitResult fit = FitOne(Noisy(record));
  EXPECT_NE(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  EXPECT_EQ(fit.records[0].first_stroke, 0);
}

TEST(LawChoice, IsNotMadeByAFirstStrokeOfUnknownPast) {
  // Dahl's own law without its first rows, and Masing's after cycles of half the amplitude, both
  // begin under a force: Dahl's law fits either, and both are given.
  History after = Cycling(Wave::kSine, kGrossSlip, 2.0, kPerCycle);
  after.pop_back();
  std::ranges::copy(Cycling(Wave::kSine, 2 * kGrossSlip, 4.0, kPerCycle),
                    std::back_inserter(after));
  const Record with_past = MakeRecord(after, Respond(Model("mindlin-dahl"), kMindlin, after));
  for (const auto& [record, state] :
       {std::pair(From(Noisy(Virgin("dahl", 2 * kGrossSlip, 4.0)), 3), "rows missing"),
        std::pair(From(Noisy(with_past), 2 * kPerCycle), "a past")}) {
    const FitResult fit = FitOne(record);
    ASSERT_TRUE(fit.law_choice) << state;
    EXPECT_FALSE(fit.law_choice->decided()) << state;
    EXPECT_LT(*fit.law_choice->delta_aicc, -10.0) << state;
    EXPECT_EQ(fit.model->name, "mindlin-dahl") << state;
    EXPECT_NE(fit.adequacy.verdict, AdequacyVerdict::kAdequate) << state;
    const ParameterEstimate& sigma = *fit.Find("sigma");
    EXPECT_LT(*sigma.lower95, kMindlin.tangential_stiffness) << state;
    EXPECT_GT(*sigma.upper95, kMindlin.tangential_stiffness) << state;
  }
}

TEST(LawChoice, IsNotMadeByTheRestOfOneBranchAndHalfTheNext) {
  Generator generator(3);
  const Record cycled = Virgin("mindlin-dahl", 0.6 * kGrossSlip, 2.7);
  const Record record = WithForceNoise(From(cycled, 2 * kPerCycle), 0.04, generator);
  const FitResult fit = FitOne(record);
  EXPECT_FALSE(fit.law_choice && fit.law_choice->decided());
  const ParameterEstimate& sigma = *fit.Find("sigma");
  EXPECT_LT(*sigma.lower95, kMindlin.tangential_stiffness);
  EXPECT_GT(*sigma.upper95, kMindlin.tangential_stiffness);
}

TEST(LawChoice, IsMadeByASecondAmplitude) {
  for (const char* model : {"mindlin-dahl", "dahl"}) {
    const Record record = Noisy(TwoAmplitudes(model, 1.2 * kGrossSlip, 0.5 * kGrossSlip));
    for (const char* fitted : {"mindlin-dahl", "dahl"}) {
      const FitResult fit = FitOne(record, OfModel(fitted));
      ASSERT_TRUE(fit.law_choice) << model << ' ' << fitted;
      EXPECT_TRUE(fit.law_choice->decided()) << model << ' ' << fitted;
      EXPECT_EQ(fit.law_choice->preferred->name, model) << fitted;
    }
  }
}

TEST(LawChoice, IsNotMadeWhereNoiseHidesTheDifference) {
  Generator generator(11);
  const FitResult fit = FitOne(WithForceNoise(Virgin("mindlin-dahl"), 200 * kNoise, generator));
  ASSERT_TRUE(fit.law_choice);
  EXPECT_FALSE(fit.law_choice->decided());
}

TEST(LawChoice, KeepsAlphaWhereItIsHeld) {
  const FitResult fit = FitOne(Noisy(Virgin("mindlin-dahl")), OfModel("mindlin"));
  ASSERT_TRUE(fit.law_choice);
  EXPECT_EQ(fit.law_choice->law.shape_exponent, kMindlin.shape_exponent);
  EXPECT_EQ(fit.law_choice->preferred->name, "mindlin");
}

TEST(LawChoice, IsNoneWhereTheLawsAreOneOrAParameterIsHeld) {
  EXPECT_FALSE(FitOne(Noisy(Steady(2 * kGrossSlip)), OfModel("jenkins")).law_choice);
  // Before the motion turns.
  Record rising = Virgin("mindlin-dahl");
  rising.displacement.resize(kPerCycle / 4);
  rising.force.resize(kPerCycle / 4);
  EXPECT_FALSE(FitOne(Noisy(rising)).law_choice);
  EXPECT_FALSE(
      FitOne(Noisy(Steady()), {.fixed = {{"sigma", kMindlin.tangential_stiffness}}}).law_choice);
  const Record record = Noisy(Steady());
  EXPECT_FALSE(Fit({&record, 1}, {}, Depth::kIntervals).law_choice) << "not asked for";
}

TEST(LawChoice, IsMadeWithinABoundThatExcludesNothing) {
  const FitResult fit = FitOne(Noisy(Virgin("dahl")), {.bounds = {{"sigma", {1e5, 1e10}}}});
  ASSERT_TRUE(fit.law_choice && fit.law_choice->decided());
  EXPECT_EQ(fit.law_choice->preferred->name, "dahl");
}

TEST(LawChoice, OfAnEncodersRecordIsNotThatOfItsSteepBranches) {
  // Ten steps an amplitude: before residuals were weighted five of forty such loops were Dahl's
  // own.
  constexpr int kLoops = 20;
  constexpr double kAmplitude = 2 * kGrossSlip;
  constexpr double kStep = kAmplitude / 10;
  for (int seed = 1; seed <= kLoops; ++seed) {
    Generator generator(static_cast<std::uint64_t>(seed));
    Record record = WithForceNoise(Virgin("mindlin-dahl", kAmplitude), kNoise, generator);
    const double phase = Uniform(generator, 0, 1);
    for (double& x : record.displacement) x = kStep * (std::round(x / kStep + phase) - phase);
    const FitResult fit = FitOne(record);
    EXPECT_FALSE(fit.law_choice && fit.law_choice->prefers_alternative()) << seed;
  }
}

}  // namespace
}  // namespace mindahl::identification::law_choice_test
