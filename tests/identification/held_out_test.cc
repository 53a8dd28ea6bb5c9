#include "identification/held_out.h"

#include "identification/term_scores.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Fits predict parts of records that they have not seen, and terms are scored by first-order steps.
namespace mindahl::identification::held_out_test {
namespace {

/// A record that turns at 10, 20, … 70, of which the samples from one on count.
FitResult FitThatTurns() {
  FitResult fit;
  fit.records.resize(1);
  fit.records[0].reversals = {10, 20, 30, 40, 50, 60, 70};
  return fit;
}

SampleMask CountingFrom(std::size_t first) {
  SampleMask mask = {std::vector<unsigned char>(80, 0)};
  for (std::size_t i = first; i < mask[0].size(); ++i) mask[0][i] = 1;
  return mask;
}

TEST(CyclesOf, BeginWithTheFirstTurn) {
  const FitResult fit = FitThatTurns();
  const std::vector<Part> all = CyclesOf(fit, CountingFrom(0));
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].begin, 10U);
  EXPECT_EQ(all[0].end, 30U);
  EXPECT_EQ(all[0].samples, 20.0);
}

/// Three cycles of 100 samples from rest: they turn at 25, 75, … 275, and two of them close.
struct ThreeCycles {
  ThreeCycles() {
    const History displacement = Cycling(Wave::kSine, 3e-6, 3.0, 100);
    const models::BranchLaw law{4e7, 1.0 / 3, 40.0};
    Generator generator(3);
    record = WithForceNoise(testing::LoopOf(law, displacement), 0.2, generator);
    options.initial_state = models::InitialState::kVirgin;
    fit = FitOne(record, options);
    views = {record};
    samples = CountedSamples(fit, views);
    cycles = CyclesOf(fit, samples.mask);
  }

  std::optional<double> Predict(std::size_t free) const {
    return PredictParts(views, ContinuedFrom(fit, options), free, samples, cycles, 2);
  }

  loop::Record record;
  FitOptions options;
  FitResult fit;
  std::vector<loop::RecordView> views;
  ScoredSamples samples;
  std::vector<Part> cycles;
};

TEST(PredictParts, IsTheMeanSquareOfFitsThatHaveNotSeenThePart) {
  const ThreeCycles made;
  const std::optional<double> predicted = made.Predict(5);
  ASSERT_TRUE(predicted);
  ASSERT_THAT(made.cycles, SizeIs(2));
  double squares = 0.0;
  for (const Part& cycle : made.cycles) {
    FitOptions rest = made.options;
    rest.preparation.held_out = {std::vector<bool>(301, false)};
    for (std::size_t i = cycle.begin; i < cycle.end; ++i) rest.preparation.held_out[0][i] = true;
    const FitResult fit = FitOne(made.record, rest);
    for (std::size_t i = cycle.begin; i < cycle.end; ++i) {
      squares += fit.records[0].residual[i] * fit.records[0].residual[i];
    }
  }
  // Two searches of one minimum, where the mean square is flat to the root of their tolerance.
  constexpr double kSameMinimum = 1e-4;
  EXPECT_NEAR(*predicted / (squares / 200), 1.0, kSameMinimum);
}

TEST(TermScores, ValuesOfLinearTermsAreThoseOfTheFitWithThem) {
  constexpr models::BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
  constexpr double kViscosity = 1e4;  // [N s/m]: 0.6 N at 6e-5 m/s
  constexpr double kDrift = 0.8;      // [N/s]
  const History displacement = Cycling(Wave::kSine, 2e-6, 3.0, 200);
  loop::Record record = Timed(testing::LoopOf(kLaw, displacement), 0.001);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double rate = 10 * std::numbers::pi;
    record.force[i] +=
        kDrift * record.time[i] + kViscosity * 2e-6 * rate * std::cos(rate * record.time[i]);
  }
  FitOptions options;
  options.preparation.force_sense = 1;
  const FitResult fit = FitOne(record, options);
  const std::vector<TermChoice> choices = {{.terms = {"viscous", "force_drift"}, .covariate = ""}};
  const std::vector<loop::RecordView> views = {record};
  TermScores scores(views, options, choices);
  scores.StepFrom(fit, options, choices);
  const std::optional<TermScore> score = scores.Of(0);
  ASSERT_TRUE(score);
  // The law moves, too, which one step does only to first order.
  EXPECT_NEAR(score->values.at("viscous") / kViscosity, 1, 0.05);
  EXPECT_NEAR(score->values.at("force_drift") / kDrift, 1, 0.05);
  EXPECT_GT(score->gain, 0.5);
  EXPECT_LT(score->p_value, 1e-6);
}

}  // namespace
}  // namespace mindahl::identification::held_out_test
