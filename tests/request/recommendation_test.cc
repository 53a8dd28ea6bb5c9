#include "mindahl/request/recommendation.h"

#include <nlohmann/json.hpp>

#include "support/histories.h"
#include "support/page_text.h"
#include "support/prelude.h"

// These tests concern the model recommended for a motion or a record, and the stated reason.
namespace mindahl::request::recommendation_test {
namespace {

const Tell kIgnore = [](std::string_view) {};

/// A sine of a fifth more than gross slip, along which Mindlin's contact is to be computed.
RecommendationRequest Sine(double tolerance) {
  RecommendationRequest request;
  request.law.sigma = 4e7;
  request.law.slip_force = 40.0;
  request.drive.lambda = 1.2;
  request.drive.excitation.cycles = 3;
  request.drive.excitation.samples_per_cycle = 60;
  request.asked.tolerance = tolerance;
  return request;
}

TEST(MakeRecommendation, IsTheCheapestThatMeetsTheTolerance) {
  const MotionRecommendation made = MakeRecommendation(Sine(0.3), kIgnore);
  ASSERT_TRUE(made.established());
  const auto& candidates = made.found.candidates;
  const tradeoff::Candidate& choice = candidates[*made.found.choice];
  EXPECT_LE(choice.point.precision.max_force, 0.3);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const tradeoff::WorkPrecision& point = candidates[i].point;
    EXPECT_EQ(candidates[i].meets, point.precision.max_force <= 0.3) << i;
    if (!candidates[i].meets) continue;
    EXPECT_LE(choice.point.cost, 1.1 * point.cost) << i;  // as precise as costs are known
  }
  EXPECT_EQ(made.samples, 181U);
  EXPECT_NEAR(made.found.cycles, 3.0, 1e-12);
}

TEST(MakeRecommendation, SaysHowManyTimesAsFastTheChoiceIs) {
  const MotionRecommendation made = MakeRecommendation(Sine(0.3), kIgnore);
  const auto& candidates = made.found.candidates;
  ASSERT_NE(*made.found.choice, made.found.exact);
  const double ratio =
      candidates[made.found.exact].point.cost / candidates[*made.found.choice].point.cost;
  EXPECT_GT(ratio, 1.0);
  const std::string text = ToText(made);
  const std::size_t at = text.find(" times as fast");
  ASSERT_NE(at, std::string::npos);
  const std::size_t begin = text.find_last_of(" \n", at - 1) + 1;
  EXPECT_NEAR(std::stod(text.substr(begin)), ratio, 0.05);  // one decimal
}

TEST(MakeRecommendation, OfALimitOfCostIsTheMostPreciseWithinIt) {
  RecommendationRequest request = Sine(0.01);
  request.asked.largest_cost = 20.0;
  const MotionRecommendation made = MakeRecommendation(request, kIgnore);
  ASSERT_TRUE(made.established());
  const auto& candidates = made.found.candidates;
  const tradeoff::Candidate& choice = candidates[*made.found.choice];
  for (const tradeoff::Candidate& candidate : candidates) {
    EXPECT_EQ(candidate.meets, candidate.point.cost <= 20.0);
    if (!candidate.meets) continue;
    EXPECT_LE(choice.point.precision.max_force, candidate.point.precision.max_force);
  }
  EXPECT_FALSE(made.found.after_transient);
}

TEST(MakeRecommendation, OffersAfterItsTransientOnlyWhatDoesNotMeetTheToleranceAtOnce) {
  for (const double tolerance : {0.3, 0.03, 0.003, 0.0003}) {
    const MotionRecommendation made = MakeRecommendation(Sine(tolerance), kIgnore);
    if (!made.found.after_transient) continue;
    const tradeoff::Candidate& later = made.found.candidates[*made.found.after_transient];
    EXPECT_FALSE(later.meets) << tolerance;
    ASSERT_TRUE(later.settles_after) << tolerance;
    EXPECT_GT(*later.settles_after, 0U) << tolerance;
    EXPECT_LT(*made.found.after_transient, made.found.choice.value_or(made.found.exact));
  }
}

TEST(MakeRecommendation, JsonHasWhatWasFound) {
  const MotionRecommendation made = MakeRecommendation(Sine(0.3), kIgnore);
  const auto json = nlohmann::json::parse(ToJson(made));
  EXPECT_EQ(json["excitation"]["samples"], 181);
  EXPECT_EQ(json["excitation"]["peak_force"], made.found.peak_force);
  EXPECT_EQ(json["law"]["alpha"], 1.0 / 3);
  EXPECT_EQ(json["tolerance"], 0.3);
  EXPECT_TRUE(json["largest_cost"].is_null());
  ASSERT_EQ(json["candidates"].size(), made.found.candidates.size());
  const auto& choice = made.found.candidates[*made.found.choice];
  EXPECT_EQ(json["choice"], json["candidates"][*made.found.choice]);
  EXPECT_EQ(json["choice"]["model"], choice.point.approximation.model);
  EXPECT_EQ(json["choice"]["cost_ns_per_sample"], choice.point.cost);
  EXPECT_EQ(json["choice"]["max_force_error"], choice.point.precision.max_force);
}

TEST(RecommendForRecord, IsTheCheapestOfThoseThatTheRecordDoesNotDistinguish) {
  loop::Record record;
  for (int i = 0; i <= 180; ++i) {
    record.displacement.push_back(1.8e-6 * std::sin(2 * std::numbers::pi * i / 60));
  }
  record.force =
      testing::Respond(testing::Model("mindlin"), {4e7, 1.0 / 3, 40.0}, record.displacement);
  Generator generator(5);
  for (double& force : record.force) force += 2.0 * testing::Normal(generator);
  const RecordRecommendation priced = RecommendForRecord("r.csv", record, kIgnore);
  ASSERT_EQ(priced.cost.size(), priced.laws.scores.size());
  EXPECT_FALSE(priced.laws.scores[priced.choice].told_apart);
  for (std::size_t i = 0; i < priced.cost.size(); ++i) {
    const identification::LawScore& score = priced.laws.scores[i];
    if (!score.told_apart) {
      EXPECT_LE(priced.cost[priced.choice], 1.1 * priced.cost[i]) << i;
    }
    const bool is_limit = score.model == "spring" || score.model == "coulomb";
    const tradeoff::Approximation approximation{score.model, is_limit ? "" : "exact"};
    // Counted operations at their prices, over the samples.
    const methods::OperationCount count =
        tradeoff::CountOperations(approximation, score.law, {.displacement = record.displacement});
    EXPECT_EQ(priced.cost[i], tradeoff::ModelledCost(count, 181)) << i;
  }
  const auto json = nlohmann::json::parse(ToJson(priced));
  EXPECT_EQ(json["record"]["samples"], 181);
  for (std::size_t i = 0; i < priced.cost.size(); ++i) {
    const auto& row = json["laws"][i];
    const identification::LawScore& score = priced.laws.scores[i];
    EXPECT_EQ(row["model"], score.model);
    EXPECT_EQ(row["cost_ns_per_sample"], priced.cost[i]);
    EXPECT_EQ(row["rms"], score.rms);
    EXPECT_EQ(row["delta_aicc"], score.delta_aicc);
    EXPECT_EQ(row["told_apart"], score.told_apart);
    EXPECT_EQ(row["best"], i == priced.laws.best);
    EXPECT_EQ(row["choice"], i == priced.choice);
    EXPECT_EQ(row["sigma"].is_null(), score.model == "coulomb");
    EXPECT_EQ(row["slip_force"].is_null(), score.model == "spring");
  }
}

TEST(RecommendForRecord, SaysInWhatTheChoiceDiffersFromTheBest) {
  RecordRecommendation priced;
  priced.record = "r.csv";
  priced.laws.scores = {{.model = "jenkins",
                         .law = {4e7, 0.0, 30.0},
                         .free_parameters = 2,
                         .converged = true,
                         .rms = 1.25,
                         .misfit = 0.75,
                         .delta_aicc = 1.5,
                         .likelihood_ratio = 3.5,
                         .p_value = 0.0625,
                         .told_apart = false},
                        {.model = "dahl",
                         .exponent_is_one = true,
                         .law = {4e7, 1.0, 40.0},
                         .free_parameters = 3,
                         .converged = true,
                         .rms = 0.5,
                         .p_value = {},
                         .told_apart = false}};
  priced.laws.best = 1;
  priced.laws.samples = 181;
  priced.laws.peak_force = 25.0;
  priced.laws.describes_record = true;
  priced.cost = {3.0, 12.0};
  const auto said = [&] { return testing::Unbroken(ToText(priced)); };
  EXPECT_THAT(said(), HasSubstr("jenkins: the record does not distinguish it from dahl with alpha "
                                "= 1, the best (dAICc = 1.5); it differs from it by 0.75 N rms, 3 "
                                "% of the peak force, against noise of 0.5 N"));
  priced.choice = 1;
  EXPECT_THAT(said(), HasSubstr("dahl with alpha = 1: the best, and nothing cheaper is as good"));
}

}  // namespace
}  // namespace mindahl::request::recommendation_test
