#include "mindahl/identification/model_comparison.h"

#include "recovery/recovered.h"
#include "support/measured.h"
#include "support/prelude.h"

// How models compare on records of known contacts.
namespace mindahl::identification::model_comparison_test {
namespace {

constexpr BranchLaw kMindlin{5e7, 1.0 / 3.0, 60.0};  // slips at 1.8e-6 m
constexpr double kReach = 2.2e-6;
constexpr double kQuiet = 0.005;  // noise over the slip force
/// Estimates of noise lie within this many of their standard errors: beyond it once in 10⁷.
constexpr double kStandardErrors = 5.3;

struct Loops {
  std::string_view model = "mindlin";
  BranchLaw law = kMindlin;
  SeriesSpring rig{};
  double reach = kReach;
  double cycles = 4.3;
  double noise = kQuiet;  // over the slip force
};

Record Measure(const Loops& loops, std::uint64_t seed) {
  const History displacement = Cycling(Wave::kSine, loops.reach, loops.cycles, 60);
  Generator generator(seed);
  return WithForceNoise(
      MakeRecord(displacement, Respond(Model(loops.model), loops.law, displacement, {}, loops.rig)),
      loops.noise * loops.law.slip_force, generator);
}

std::vector<ModelScore> Compare(const std::vector<Record>& records, FitOptions options = {}) {
  if (!options.initial_state) options.initial_state = InitialState::kVirgin;
  return CompareModels(records, options);
}

const ModelScore& ScoreOf(const std::vector<ModelScore>& scores, std::string_view model, bool rig) {
  return *std::ranges::find_if(scores, [&](const ModelScore& score) {
    return score.model->name == model && score.rig == rig;
  });
}

/// The least AICc.
std::string BestOf(const std::vector<ModelScore>& scores) {
  const ModelScore& score = *std::ranges::min_element(scores, {}, &ModelScore::delta_aicc);
  EXPECT_EQ(score.delta_aicc, 0.0);
  return std::string(score.model->name) + (score.rig ? "+rig" : "");
}

TEST(CompareModels, AMindlinLoopIsMindlinsAndNotDahls) {
  const Record record = Measure({}, 1);
  const std::vector<ModelScore> scores = Compare({record});
  EXPECT_EQ(BestOf(scores), "mindlin");
  // All of the noise and no more is left, in the fit and in prediction.
  const double noise = kQuiet * kMindlin.slip_force;
  const auto count = static_cast<double>(record.size());
  const double tolerance = noise * (kStandardErrors / std::sqrt(2 * count) + 4 / count);
  const ModelScore& mindlin = ScoreOf(scores, "mindlin", false);
  EXPECT_NEAR(mindlin.rms, noise, tolerance);
  ASSERT_TRUE(mindlin.held_out_rms);
  EXPECT_NEAR(*mindlin.held_out_rms, noise, 2 * tolerance);

  // Its steady loop dissipates twice as much (docs/theory.md §6), with α free somewhat less.
  const ModelScore& dahl = ScoreOf(scores, "dahl", false);
  EXPECT_GT(dahl.rms, 1.5 * noise);
  EXPECT_GT(dahl.delta_aicc, 100);
  EXPECT_GT(*ScoreOf(scores, "jenkins", false).held_out_rms, 3 * *mindlin.held_out_rms);
}

TEST(CompareModels, PredictionIsByFitsThatHaveNotSeenTheCycles) {
  // The record has two cycles from the first turn at sample 15; a fit to the rest predicts each.
  const Record record = Measure({.cycles = 2.3}, 3);
  const ModelScore score = ScoreOf(Compare({record}), "mindlin", false);
  ASSERT_TRUE(score.held_out_rms);
  double squares = 0.0;
  for (const std::size_t begin : {15, 75}) {
    FitOptions rest;
    rest.model = score.model;
    rest.initial_state = InitialState::kVirgin;
    rest.preparation.held_out = {std::vector<bool>(record.size(), false)};
    for (std::size_t i = begin; i < begin + 60; ++i) rest.preparation.held_out[0][i] = true;
    const FitResult fit = FitOne(record, rest);
    for (std::size_t i = begin; i < begin + 60; ++i) {
      squares += fit.records[0].residual[i] * fit.records[0].residual[i];
    }
  }
  // Two searches of one minimum, where the mean square is flat to the root of their tolerance.
  constexpr double kSameMinimum = 1e-4;
  EXPECT_NEAR(*score.held_out_rms / std::sqrt(squares / 120), 1.0, kSameMinimum);
}

TEST(CompareModels, CriterionFollowsItsFormula) {
  const Record record = Measure({}, 1);
  const std::vector<ModelScore> scores = Compare({record});
  const ModelScore& reference = ScoreOf(scores, "mindlin", false);
  FitOptions options{.model = std::ranges::min_element(scores, {}, &ModelScore::rms)->model,
                     .initial_state = InitialState::kVirgin};
  if (std::ranges::min_element(scores, {}, &ModelScore::rms)->rig) {
    options.terms = {"rig_stiffness"};
  }
  const double samples = Fit({&record, 1}, options).residuals.effective_samples;
  EXPECT_EQ(scores.size(), 8u);
  for (const ModelScore& score : scores) {
    // σ, Tc and two offsets; α unless it is prescribed; the rig
    EXPECT_EQ(score.free_parameters,
              4u + (score.model->shape_exponent ? 0u : 1u) + (score.rig ? 1u : 0u));
    EXPECT_GE(score.delta_aicc, 0);
    const auto penalty = [n = static_cast<double>(record.size())](std::size_t p) {
      const auto k = static_cast<double>(p + 1);
      return 2 * k + 2 * k * (k + 1) / (n - k - 1);
    };
    const double expected = 2 * samples * std::log(score.rms / reference.rms) +
                            penalty(score.free_parameters) - penalty(reference.free_parameters);
    // Differences of sums of a thousand units of log-likelihood.
    EXPECT_NEAR(score.delta_aicc - reference.delta_aicc, expected, 1e-9);
  }
}

TEST(CompareModels, FindTheModelThatMadeTheLoopFarAheadOfAnother) {
  struct Case {
    Loops loops;
    std::string_view best;
    std::string_view other;
  };
  for (const Case& c : {Case{{.model = "jenkins", .law = {5e7, 0.0, 60.0}}, "jenkins", "mindlin"},
                        {{.model = "dahl", .law = {5e7, 1.0, 60.0}}, "dahl", "mindlin-dahl"},
                        {{.rig = {.stiffness = 5e7}, .reach = 3e-6}, "mindlin+rig", "mindlin"}}) {
    const auto scores = Compare({Measure(c.loops, 3)});
    EXPECT_EQ(BestOf(scores), c.best);
    EXPECT_GT(ScoreOf(scores, c.other, false).delta_aicc, 100) << c.best;
  }
  // Records are judged together.
  EXPECT_EQ(
      BestOf(Compare({Measure({.cycles = 2.3}, 8), Measure({.reach = 1.2e-6, .cycles = 3.3}, 9)})),
      "mindlin");
}

TEST(CompareModels, WithOneClosedCycleNothingIsHeldOut) {
  const auto scores = Compare({Measure({.cycles = 1.5}, 7)});
  EXPECT_EQ(BestOf(scores), "mindlin");
  for (const ModelScore& score : scores) EXPECT_FALSE(score.held_out_rms);
}

TEST(CompareModels, KnownPropertiesLimitTheCandidates) {
  const Record record = Measure({.cycles = 1.5}, 12);
  EXPECT_EQ(Compare({record}, {.fixed = {{"rig_stiffness", 1e9}}}).size(), 4u);
  const std::vector<ModelScore> scores = Compare({record}, {.fixed = {{"alpha", 0.5}}});
  ASSERT_EQ(scores.size(), 4u);
  for (const ModelScore& score : scores) EXPECT_FALSE(score.model->shape_exponent);
}

TEST(CompareModels, TheTribometerDoesNotTellAFreeShapeFromASoftRig) {
  const auto rows = testing::ReadMeasured("tribometer/test_data_2.txt", '\t');
  if (!rows) GTEST_SKIP() << "no measured record " << testing::MeasuredPath("tribometer");
  // Nine cycles at 200 samples a second: neighbours say nothing new.
  constexpr std::size_t kEvery = 8;
  Record record;
  for (std::size_t i = 0; i < rows->size(); i += kEvery) {
    const std::vector<double>& row = (*rows)[i];
    if (row[0] < 20 || row[0] > 60) continue;
    record.time.push_back(row[0]);
    record.displacement.push_back(row[2] * 1e-3);
    record.force.push_back(row[3] * 1e-6);
  }
  const std::vector<ModelScore> scores = CompareModels({&record, 1}, {});
  for (const bool rig : {false, true}) {
    const ModelScore& score = ScoreOf(scores, rig ? "mindlin" : "mindlin-dahl", rig);
    EXPECT_LT(score.delta_aicc, 4.0);
    EXPECT_NEAR(score.rms / 2.35, 0.045, 0.003);  // as in tests/cli/measured_test.cc
  }
}

}  // namespace
}  // namespace mindahl::identification::model_comparison_test
