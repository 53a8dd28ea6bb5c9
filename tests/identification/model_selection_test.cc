#include "mindahl/identification/model_selection.h"

#include "recovery/recovered.h"
#include "support/measured.h"
#include "support/prelude.h"

// Which model SelectModel finds behind records of known contacts, and when it says that it cannot.
namespace mindahl::identification::model_selection_test {
namespace {

using namespace loop;
using namespace models;

using testing::PathOf;

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
  const FrictionModel& model = Model(loops.model);
  std::vector<double> force(displacement.size());
  EvaluateForce(model, loops.law, PathOf(model, displacement), displacement, force, loops.rig);
  Generator generator(seed);
  return WithForceNoise(MakeRecord(displacement, force), loops.noise * loops.law.slip_force,
                        generator);
}

/// Few cycles and folds: the tests are many.
ModelSelection Select(const std::vector<Record>& records, FitOptions options = {}) {
  options.initial_state = options.initial_state.value_or(InitialState::kVirgin);
  return SelectModel(records, options, {.folds = 2});
}

const ModelScore& ScoreOf(const ModelSelection& selection, std::string_view model, bool rig) {
  return *std::ranges::find_if(selection.scores, [&](const ModelScore& score) {
    return score.model->name == model && score.rig == rig;
  });
}

std::string Chosen(const ModelSelection& selection) {
  const ModelScore& score = selection.scores[selection.chosen];
  return std::string(score.model->name) + (score.rig ? "+rig" : "");
}

TEST(ModelSelection, AMindlinLoopIsMindlinsAndNotDahls) {
  const Record record = Measure({}, 1);
  const ModelSelection selection = Select({record});
  EXPECT_EQ(Chosen(selection), "mindlin");
  EXPECT_EQ(selection.fit.model, &Model("mindlin"));
  EXPECT_TRUE(selection.fit.converged);
  EXPECT_THAT(selection.indistinguishable, Contains(selection.chosen));
  EXPECT_THAT(selection.verdict, HasSubstr("mindlin"));

  // All of the noise and no more is left, in the fit and in prediction.
  const double noise = kQuiet * kMindlin.slip_force;
  const auto count = static_cast<double>(record.size());
  const double tolerance = noise * (kStandardErrors / std::sqrt(2 * count) + 4 / count);
  const ModelScore& mindlin = selection.scores[selection.chosen];
  EXPECT_NEAR(mindlin.rms, noise, tolerance);
  ASSERT_EQ(selection.held_out_cycles, 4u);
  ASSERT_TRUE(mindlin.held_out_rms && mindlin.held_out_standard_error);
  EXPECT_NEAR(*mindlin.held_out_rms, noise, 2 * tolerance);
  EXPECT_GT(*mindlin.held_out_standard_error, 0);

  // Its steady loop dissipates twice as much (docs/theory.md §6), with α free somewhat less.
  const ModelScore& dahl = ScoreOf(selection, "dahl", false);
  EXPECT_GT(dahl.rms, 1.5 * noise);
  EXPECT_GT(dahl.delta_aicc, 100);
  const ModelScore& jenkins = ScoreOf(selection, "jenkins", false);
  EXPECT_GT(*jenkins.held_out_rms, 3 * *mindlin.held_out_rms);
}

TEST(ModelSelection, CriterionFollowsItsFormula) {
  const ModelSelection selection = Select({Measure({}, 1)});
  double weights = 0.0;
  const ModelScore& reference = selection.scores[selection.chosen];
  for (const ModelScore& score : selection.scores) {
    ASSERT_TRUE(score.converged);
    // σ, Tc and two offsets; α unless it is prescribed; the rig
    EXPECT_EQ(score.free_parameters,
              4u + (score.model->shape_exponent ? 0u : 1u) + (score.rig ? 1u : 0u));
    EXPECT_GE(score.delta_aicc, 0);
    weights += score.akaike_weight;
    const auto penalty = [n = static_cast<double>(selection.fit.residuals.samples)](std::size_t p) {
      const auto k = static_cast<double>(p + 1);
      return 2 * k + 2 * k * (k + 1) / (n - k - 1);
    };
    const double expected = 2 * selection.effective_samples * std::log(score.rms / reference.rms) +
                            penalty(score.free_parameters) - penalty(reference.free_parameters);
    // Differences of sums of a thousand units of log-likelihood.
    EXPECT_NEAR(score.aicc - reference.aicc, expected, 1e-9);
    EXPECT_NEAR(score.akaike_weight / reference.akaike_weight,
                std::exp(-(score.aicc - reference.aicc) / 2), 1e-9);
  }
  EXPECT_NEAR(weights, 1.0, 1e-12);
}

TEST(ModelSelection, AJenkinsLoopIsJenkinsAndARigInSeriesIsPartOfItsSpring) {
  const ModelSelection selection =
      Select({Measure({.model = "jenkins", .law = {5e7, 0.0, 60.0}}, 2)});
  EXPECT_EQ(Chosen(selection), "jenkins");
  const ModelScore& with_rig = ScoreOf(selection, "jenkins", true);
  EXPECT_TRUE(with_rig.redundant);
  EXPECT_THAT(with_rig.remark, HasSubstr("rig not needed"));
  EXPECT_GT(ScoreOf(selection, "mindlin", false).delta_aicc, 100);
}

TEST(ModelSelection, DahlsLoopIsDahls) {
  const ModelSelection selection = Select({Measure({.model = "dahl", .law = {5e7, 1.0, 60.0}}, 3)});
  EXPECT_EQ(Chosen(selection), "dahl");
  EXPECT_GT(ScoreOf(selection, "mindlin-dahl", false).delta_aicc, 100);
  EXPECT_THAT(selection.verdict, HasSubstr("dahl is the best"));
}

TEST(ModelSelection, FindsCompliantRigWithItsStiffness) {
  const SeriesSpring rig{.stiffness = 5e7};
  const ModelSelection selection = Select({Measure({.rig = rig, .reach = 3e-6}, 4)});
  EXPECT_EQ(Chosen(selection), "mindlin+rig");
  const ParameterEstimate* stiffness = selection.fit.Find("rig_stiffness");
  ASSERT_NE(stiffness, nullptr);
  ASSERT_TRUE(stiffness->standard_error);
  EXPECT_NEAR(std::log(stiffness->value / rig.stiffness), 0,
              kStandardErrors * *stiffness->standard_error / stiffness->value);
  EXPECT_GT(ScoreOf(selection, "mindlin", false).delta_aicc, 100);
}

TEST(ModelSelection, ARigThatRunsRigidIsNotNeededAndNeverChosen) {
  const ModelSelection selection = Select({Measure({.noise = 0.0}, 0)});
  EXPECT_EQ(Chosen(selection), "mindlin");
  for (const std::string_view model : {"mindlin", "mindlin-dahl"}) {
    const ModelScore& with_rig = ScoreOf(selection, model, true);
    EXPECT_TRUE(with_rig.redundant) << model;
    EXPECT_THAT(with_rig.remark, HasSubstr("rig not needed")) << model;
  }
  for (const std::size_t i : selection.indistinguishable) EXPECT_FALSE(selection.scores[i].rig);
}

TEST(ModelSelection, UnderMuchNoiseSeveralAreNamedAndTheSimplestIsReported) {
  const ModelSelection selection = Select({Measure({.noise = 0.2}, 5)});
  EXPECT_GT(selection.indistinguishable.size(), 1u);
  const ModelScore& chosen = selection.scores[selection.chosen];
  EXPECT_FALSE(chosen.rig);
  for (const std::size_t i : selection.indistinguishable) {
    EXPECT_GE(selection.scores[i].free_parameters, chosen.free_parameters);
    EXPECT_LT(selection.scores[i].delta_aicc, 4.0);
    EXPECT_THAT(selection.verdict, HasSubstr(std::string(selection.scores[i].model->name)));
  }
  EXPECT_THAT(selection.verdict, HasSubstr("do not distinguish"));
}

TEST(ModelSelection, TheCriterionDoesNotTellAFreeShapeFromASoftRigInNoise) {
  const ModelSelection selection =
      Select({Measure({.rig = {.stiffness = 5e7}, .reach = 3e-6, .noise = 0.2}, 6)});
  EXPECT_LT(ScoreOf(selection, "mindlin-dahl", false).delta_aicc, 4.0);
  EXPECT_LT(ScoreOf(selection, "mindlin", true).delta_aicc, 4.0);
}

TEST(ModelSelection, WithOneClosedCycleNothingIsHeldOut) {
  const ModelSelection selection = Select({Measure({.cycles = 1.5}, 7)});
  EXPECT_EQ(selection.held_out_cycles, 0u);
  EXPECT_EQ(Chosen(selection), "mindlin");
  for (const ModelScore& score : selection.scores) EXPECT_FALSE(score.held_out_rms);
  EXPECT_THAT(selection.verdict, HasSubstr("nothing was held out"));
}

TEST(ModelSelection, RecordsAreJudgedTogether) {
  const ModelSelection selection =
      Select({Measure({.cycles = 2.3}, 8), Measure({.reach = 1.2e-6, .cycles = 3.3}, 9)});
  EXPECT_EQ(Chosen(selection), "mindlin");
  EXPECT_EQ(selection.fit.records.size(), 2u);
  EXPECT_EQ(selection.held_out_cycles, 5u);
}

TEST(ModelSelection, KnownPropertiesLimitTheCandidates) {
  const Record record = Measure({.cycles = 1.5}, 12);
  FitOptions options;
  options.fixed["rig_stiffness"] = 1e9;
  ModelSelection selection = Select({record}, options);
  EXPECT_EQ(selection.scores.size(), 4u);
  EXPECT_EQ(selection.fit.rig.stiffness, 1e9);
  options.fixed = {{"alpha", 0.5}};
  selection = Select({record}, options);
  ASSERT_EQ(selection.scores.size(), 4u);
  for (const ModelScore& score : selection.scores) EXPECT_FALSE(score.model->shape_exponent);
}

TEST(ModelSelection, OptionsThatBreakARuleAreNamed) {
  const Record record = Measure({.cycles = 1.5}, 14);
  const auto refusal = [&](const FitOptions& options, const SelectionOptions& selection) {
    return MessageOf([&] { SelectModel({&record, 1}, options, selection); });
  };
  EXPECT_EQ(refusal({}, {.folds = 1}), "folds [-] = 1 is invalid: must be >= 2");
  FitOptions options;
  options.thresholds.indistinguishable = -1;
  EXPECT_EQ(refusal(options, {}), "largest ΔAICc [-] = -1 is invalid: must be finite and >= 0");
  options = {};
  options.preparation.held_out = {{}, {}};
  EXPECT_EQ(refusal(options, {}), "held-out masks has 2 values and records has 1: must be equal");
  options.preparation.held_out = {{true}};
  EXPECT_THAT(refusal(options, {}), HasSubstr("held-out mask has 1 values and samples has 91"));
  options.preparation.held_out = {std::vector<bool>(record.size(), true)};
  EXPECT_THAT(refusal(options, {}), HasSubstr("nothing is left of record 1"));
}

TEST(ModelSelection, TheTribometerDoesNotTellAFreeShapeFromASoftRig) {
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
  const ModelSelection selection = SelectModel({&record, 1}, {}, {.folds = 2});
  const auto named = [&](std::string_view model, bool rig) {
    return std::ranges::any_of(selection.indistinguishable, [&](std::size_t i) {
      return selection.scores[i].model->name == model && selection.scores[i].rig == rig;
    });
  };
  EXPECT_TRUE(named("mindlin-dahl", false)) << selection.verdict;
  EXPECT_TRUE(named("mindlin", true)) << selection.verdict;
  for (const bool rig : {false, true}) {
    const ModelScore& score = ScoreOf(selection, rig ? "mindlin" : "mindlin-dahl", rig);
    EXPECT_NEAR(score.rms / 2.35, 0.045, 0.003);  // as in tests/cli/measured_test.cc
  }
}

}  // namespace
}  // namespace mindahl::identification::model_selection_test
