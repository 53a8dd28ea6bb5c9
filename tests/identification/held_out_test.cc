#include "identification/term_scores.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Fits predict parts of records that they have not seen, and terms are scored by first-order steps.
namespace mindahl::identification::held_out_test {
namespace {

constexpr double kRounding = 1e-14;

TEST(MeanOverParts, HasTheErrorOfWeightedPartsOfFoldsThatShareTheirSamples) {
  // 1, 2, 6 of 1, 1 and 2 samples: mean 15/4, deviations weighted −11/16, −7/16 and 18/16. Three
  // parts leave two degrees of freedom, and of three folds 1 + 3/2 counts.
  const std::vector<Part> parts = {{.samples = 1}, {.samples = 1}, {.samples = 2}};
  const MeanOverParts mean = Mean(std::vector<double>{1, 2, 6}, parts, 3);
  EXPECT_NEAR(mean.mean, 3.75, kRounding);
  const double squares = (11.0 * 11 + 7.0 * 7 + 18.0 * 18) / 256;
  EXPECT_NEAR(mean.standard_error, std::sqrt(squares * 3 / 2 * 2.5), kRounding);
}

TEST(PredictsWorse, IsByMoreThanAStandardErrorOfTheDifference) {
  // The mean difference is 3.75 with a standard error of √(446/256·15/4) = 2.556, as above, then
  // 2.25 with the same error.
  const std::vector<Part> parts = {{.samples = 1}, {.samples = 1}, {.samples = 2}};
  const std::vector<double> best = {7, 5, 3};
  EXPECT_TRUE(PredictsWorse(std::vector<double>{8, 7, 9}, best, parts, 3, 0.0));
  EXPECT_FALSE(PredictsWorse(std::vector<double>{6.5, 5.5, 7.5}, best, parts, 3, 0.0));
  EXPECT_FALSE(PredictsWorse(std::vector<double>{8, 7, 9}, best, parts, 3, 1.5)) << "rounding";
  EXPECT_FALSE(PredictsWorse({}, best, parts, 3, 0.0)) << "nothing was predicted";
}

TEST(MeanOverParts, IsAboveZeroByChanceAsStudentsDistributionHasIt) {
  // Student's t exceeds 2.7764451 with a probability of 2.5 % at four degrees of freedom.
  EXPECT_NEAR(ChanceOfMean({.mean = 2.7764451 * 3, .standard_error = 3}, 5), 0.025, 1e-8);
  EXPECT_NEAR(ChanceOfMean({.mean = -2.7764451 * 3, .standard_error = 3}, 5), 0.975, 1e-8);
  EXPECT_EQ(ChanceOfMean({.mean = 1, .standard_error = 0}, 5), 0.5)
      << "parts that agree to the bit";
}

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

TEST(ClosedCycles, BeginWithTheFirstThatIsNotSkipped) {
  const FitResult fit = FitThatTurns();
  const std::vector<Part> all = ClosedCycles(fit, CountingFrom(0), 0);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].begin, 10U);
  EXPECT_EQ(all[0].end, 30U);
  EXPECT_EQ(all[0].samples, 20.0);
  // One cycle skipped: to the second turn.
  const std::vector<Part> later = ClosedCycles(fit, CountingFrom(20), 1);
  ASSERT_EQ(later.size(), 2U);
  EXPECT_EQ(later[0].begin, 20U);
  EXPECT_EQ(later[1].end, 60U);
}

TEST(Strokes, BeginWithTheFirstThatIsNotSkipped) {
  const std::vector<Part> strokes = Strokes(FitThatTurns(), CountingFrom(20), 1);
  ASSERT_EQ(strokes.size(), 5U);
  EXPECT_EQ(strokes.front().begin, 20U);
  EXPECT_EQ(strokes.back().end, 70U);
}

TEST(ContinuedFrom, HoldsWhatRanToABoundAndBeginsWithTheRest) {
  FitResult fit = FitThatTurns();
  fit.force_sense = -1;
  fit.records[0].initial_state = models::InitialState::kVirgin;
  for (const auto& [name, status] : {std::pair("sigma", ParameterStatus::kFree),
                                     {"alpha", ParameterStatus::kAtLowerBound},
                                     {"slip_force", ParameterStatus::kFixed}}) {
    ParameterEstimate& estimate = fit.parameters.emplace_back();
    estimate.name = name;
    estimate.status = status;
    estimate.value = 7.0;
  }
  const FitOptions options = ContinuedFrom(fit, {});
  EXPECT_EQ(options.start, (std::map<std::string, double>{{"sigma", 7.0}}));
  EXPECT_EQ(options.fixed, (std::map<std::string, double>{{"alpha", 7.0}}));
  EXPECT_EQ(options.starts, 1U);
  EXPECT_EQ(options.preparation.force_sense, -1);
  EXPECT_THAT(options.initial_states, ElementsAre(models::InitialState::kVirgin));
}

/// Three cycles of 100 samples from rest: they turn at 25, 75, … 275, and two of them close.
struct ThreeCycles {
  ThreeCycles() {
    const History displacement = Cycling(Wave::kSine, 3e-6, 3.0, 100);
    const models::BranchLaw law{4e7, 1.0 / 3, 40.0};
    Generator generator(3);
    record =
        WithForceNoise(MakeRecord(displacement, Respond(Model("mindlin-dahl"), law, displacement)),
                       0.2, generator);
    options.initial_state = models::InitialState::kVirgin;
    fit = FitOne(record, options);
    views = {record};
    samples = CountedSamples(fit, views);
    cycles = ClosedCycles(fit, samples.mask, 0);
  }

  std::vector<double> Predict(std::size_t free) const {
    return PredictParts(views, ContinuedFrom(fit, options), free, samples, cycles, 2);
  }

  loop::Record record;
  FitOptions options;
  FitResult fit;
  std::vector<loop::RecordView> views;
  ScoredSamples samples;
  std::vector<Part> cycles;
};

TEST(PredictParts, NeedAsManySamplesAsParametersBesideThoseHeldOut) {
  const ThreeCycles made;
  ASSERT_EQ(made.samples.count, 301U);
  ASSERT_EQ(made.cycles.size(), 2U);
  EXPECT_THAT(made.Predict(201), SizeIs(2));
  EXPECT_THAT(made.Predict(202), IsEmpty());
}

TEST(PredictParts, AreMeanSquaresOfAFitThatHasNotSeenThePart) {
  const ThreeCycles made;
  const std::vector<double> predicted = made.Predict(5);
  ASSERT_THAT(predicted, SizeIs(2));
  for (std::size_t k = 0; k < 2; ++k) {
    FitOptions rest = made.options;
    rest.preparation.held_out = {std::vector<bool>(301, false)};
    double squares = 0.0;
    for (std::size_t i = made.cycles[k].begin; i < made.cycles[k].end; ++i) {
      rest.preparation.held_out[0][i] = true;
    }
    const FitResult fit = FitOne(made.record, rest);
    for (std::size_t i = made.cycles[k].begin; i < made.cycles[k].end; ++i) {
      squares += fit.records[0].residual[i] * fit.records[0].residual[i];
    }
    // Two searches of one minimum, where the mean square is flat to the root of their tolerance.
    constexpr double kSameMinimum = 1e-4;
    EXPECT_NEAR(predicted[k] / (squares / 100), 1.0, kSameMinimum) << k;
  }
}

TEST(PredictParts, LeaveOutWhatTheOptionsHoldOut) {
  // The last quarter of a cycle is spoilt and held out: the fits to the rest must not see it.
  ThreeCycles made;
  for (std::size_t i = 276; i < 301; ++i) made.record.force[i] += 100.0;
  made.options.preparation.held_out = {std::vector<bool>(301, false)};
  for (std::size_t i = 276; i < 301; ++i) made.options.preparation.held_out[0][i] = true;
  made.views = {made.record};
  made.fit = FitOne(made.record, made.options);
  made.samples = CountedSamples(made.fit, made.views);
  EXPECT_EQ(made.samples.count, 276U);
  const std::vector<double> predicted = made.Predict(5);
  ASSERT_THAT(predicted, SizeIs(2));
  // Noise of 0.2 N: of a mean of 100 squares the error is √(2/100).
  for (const double square : predicted) EXPECT_NEAR(square / (0.2 * 0.2), 1.0, 5 * std::sqrt(0.02));
}

TEST(TermScores, ValuesOfLinearTermsAreThoseOfTheFitWithThem) {
  constexpr models::BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
  constexpr double kViscosity = 1e4;  // [N s/m]: 0.6 N at 6e-5 m/s
  constexpr double kDrift = 0.8;      // [N/s]
  const History displacement = Cycling(Wave::kSine, 2e-6, 3.0, 200);
  loop::Record record =
      MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double time = 0.2 * static_cast<double>(i) / 200;
    record.time.push_back(time);
    record.force[i] += kDrift * time;
    record.force[i] +=
        kViscosity * 2e-6 * 10 * std::numbers::pi * std::cos(10 * std::numbers::pi * time);
  }
  FitOptions options;
  options.preparation.force_sense = 1;
  const FitResult fit = FitOne(record, options);
  FitOptions with = options;
  with.terms = {"viscous", "force_drift"};
  const std::vector<loop::RecordView> views = {record};
  TermScores scores(views, options, with.terms, {});
  scores.StepFrom(fit, options, {}, 0);
  const std::optional<TermScore> score = scores.Of(with);
  ASSERT_TRUE(score);
  // The law moves, too, which one step does only to first order.
  EXPECT_NEAR(score->values.at("viscous") / kViscosity, 1, 0.05);
  EXPECT_NEAR(score->values.at("force_drift") / kDrift, 1, 0.05);
  EXPECT_LT(score->rms, 0.1 * fit.residuals.rms);
}

}  // namespace
}  // namespace mindahl::identification::held_out_test
