#include "mindahl/request/recommendation.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "support/histories.h"
#include "support/prelude.h"
#include "support/text.h"

// These tests concern the model recommended for a motion or a record, and the stated reason.
namespace mindahl::request::recommendation_test {
namespace {

using tradeoff::Approximation;

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

// --- the whole answer of what is set by hand

Approximation Own(std::string model, std::string method, methods::Resolution resolution,
                  std::optional<models::BranchLaw> law = std::nullopt) {
  return {std::move(model), std::move(method), resolution, law};
}

/// Coulomb's and Jenkins' laws with parameters of their own, Mindlin's contact by a method and
/// exactly. Each number is another.
MotionRecommendation MadeByHand() {
  MotionRecommendation made;
  made.law = {2.5, 0.75, 1.5};
  made.samples = 181;
  made.request.asked.tolerance = 0.125;
  made.request.asked.transient_cycles = 2;
  made.request.drive.path = "a b.csv";
  made.request.drive.path_unit = "um";
  made.found.peak_force = 25.5;
  made.found.cycles = 3.25;
  made.found.floor = {.memory = 0.5, .arithmetic = 2.0};
  const auto add = [&](Approximation approximation, double cost, tradeoff::Precision precision,
                       bool meets, std::optional<std::size_t> settles) {
    tradeoff::Candidate& candidate = made.found.candidates.emplace_back();
    candidate.point = {.approximation = std::move(approximation),
                       .precision = precision,
                       .cost = cost,
                       .operations = {},
                       .measured_cost = {}};
    candidate.point.operations.Add(methods::Operation::kSample, 10);
    candidate.point.operations.Add(methods::Operation::kRoot, 25);
    candidate.meets = meets;
    candidate.settles_after = settles;
  };
  add(Own("coulomb", "", {}, models::BranchLaw{9.5, 0.25, 4.5}), 2, {0.375, 0.25, {}}, false, 1);
  add(Own("jenkins", "exact", {}, models::BranchLaw{3.5, 0.25, 5.5}), 5, {0.0625, 0.03125, 0.5},
      true, 0);
  add(Own("mindlin-dahl", "iwan", {.steps = 16}), 40, {0.5, 0.375, 0.25}, false, 3);
  add(Own("mindlin-dahl", "dopri5", {.steps = 1, .tolerance = 1e-4}), 100, {0, 0, 0}, true, 0);
  add(Own("mindlin-dahl", "exact", {}), 20, {0, 0, 0}, true, {});
  made.found.choice = 1;
  made.found.exact = 4;
  made.found.after_transient = 0;
  return made;
}

TEST(MotionRecommendation, JsonHasEveryNumberUnderItsName) {
  const auto expected = nlohmann::json::parse(R"({
    "schema": "mindahl.recommend/1",
    "excitation": {"samples": 181, "cycles": 3.25, "peak_force": 25.5},
    "law": {"sigma": 2.5, "alpha": 0.75, "slip_force": 1.5},
    "criterion": "max", "tolerance": 0.125, "largest_cost": null, "transient_cycles": 2,
    "cost_floor": {"memory_ns_per_sample": 0.5, "arithmetic_ns_per_sample": 2},
    "verdict": "jenkins by exact, refitted: Jenkins element: spring and Coulomb slider",
    "choice": {"model": "jenkins", "method": "exact", "steps": null, "tolerance": null,
      "refitted": {"sigma": 3.5, "alpha": 0, "slip_force": 5.5},
      "cost_ns_per_sample": 5, "measured_ns_per_sample": null,
      "operations_per_sample": {"sample": 1, "root": 2.5},
      "max_force_error": 0.0625, "rms_force_error": 0.03125, "energy_error": 0.5,
      "meets": true, "settles_after_cycles": 0},
    "command":
      "mindahl simulate --model jenkins --sigma 3.5 --slip-force 5.5 --path 'a b.csv' --path-unit um",
    "after_transient": {"model": "coulomb", "method": null, "steps": null, "tolerance": null,
      "refitted": {"slip_force": 4.5},
      "cost_ns_per_sample": 2, "measured_ns_per_sample": null,
      "operations_per_sample": {"sample": 1, "root": 2.5},
      "max_force_error": 0.375, "rms_force_error": 0.25, "energy_error": null,
      "meets": false, "settles_after_cycles": 1}})");
  auto json = nlohmann::json::parse(ToJson(MadeByHand()));
  ASSERT_EQ(json["candidates"].size(), 5U);
  EXPECT_EQ(json["candidates"][0], expected["after_transient"]);
  EXPECT_EQ(json["candidates"][1], expected["choice"]);
  EXPECT_EQ(json["candidates"][2]["steps"], 16);
  EXPECT_TRUE(json["candidates"][2]["tolerance"].is_null());
  EXPECT_EQ(json["candidates"][3]["tolerance"], 1e-4);
  EXPECT_TRUE(json["candidates"][4]["refitted"].is_null());
  EXPECT_TRUE(json["candidates"][4]["settles_after_cycles"].is_null());
  EXPECT_THAT(json["cpp"].get<std::string>(),
              AllOf(HasSubstr("law{.tangential_stiffness = 3.5, .shape_exponent = 0, .slip_force = "
                              "5.5};"),
                    HasSubstr("Approximation{\"jenkins\", \"exact\"}, law)")));
  for (const char* key : {"version", "candidates", "cpp"}) json.erase(key);
  EXPECT_EQ(json, expected);
}

TEST(MotionRecommendation, TextHasEveryNumberInItsSentence) {
  const std::string text = ToText(MadeByHand());
  EXPECT_THAT(
      text,
      StartsWith("181 samples, 3.25 cycles, peak force 25.5 N\n"
                 "asked: the cheapest within 12.5 % (largest force error, of the peak force)\n"
                 "       errors count after 2 cycles\n\n"
                 "-> jenkins by exact, refitted: Jenkins element: spring and Coulomb slider\n"
                 "   or, once its transient is over: coulomb, refitted after 1 cycle, 2.0 "
                 "ns/sample\n"
                 "   4.0 times as fast as the exact mindlin-dahl\n"
                 "   with sigma = 3.5 N/m and Tc = 5.5 N, fitted to this excitation and valid for "
                 "no other\n"
                 "   note: it misses 50 % of the dissipated energy; where damping matters, ask "
                 "with --criterion energy\n\n"
                 "command line:\n  mindahl simulate --model jenkins "));
  EXPECT_THAT(text,
              HasSubstr("\n  #include \"mindahl/tradeoff/approximation.h\"\n  const mindahl"));
  EXPECT_THAT(text, HasSubstr("square root and division, 2.00 ns/sample):\n"));
  // The rows: cost, cost over the floor, errors of force and energy, and what they are worth.
  const std::vector<std::string> rows = {
      "coulomb, refitted 2.00 1.0 3.8e-01 2.5e-01 - force within 12.5 % after 1 cycle\n",
      "jenkins by exact, refitted 5.00 2.5 6.2e-02 3.1e-02 5.0e-01 <- this\n",
      "mindlin-dahl by iwan, 16 elements 40.00 20.0 5.0e-01 3.8e-01 2.5e-01 force within 12.5 % "
      "after 3 cycles\n",
      "mindlin-dahl by dopri5, tolerance 0.0001 100.00 50.0 0.0e+00 0.0e+00 0.0e+00 meets it\n",
      "mindlin-dahl by exact 20.00 10.0 0.0e+00 0.0e+00 0.0e+00 meets it\n"};
  const std::string single = WithSingleBlanks(text.substr(text.find("evidence")));
  for (const std::string& row : rows) EXPECT_THAT(single, HasSubstr("\n " + row));
}

TEST(MotionRecommendation, NotesAnEnergyBeyondTheToleranceOnlyWhereForcesAreAsked) {
  constexpr const char* kNote = "note: it misses";
  MotionRecommendation made = MadeByHand();
  std::optional<double>& energy = made.found.candidates[1].point.precision.energy;
  energy = made.request.asked.tolerance;
  EXPECT_THAT(ToText(made), Not(HasSubstr(kNote)));
  energy = std::nextafter(made.request.asked.tolerance, 1.0);
  EXPECT_THAT(ToText(made), HasSubstr(kNote));
  made.request.asked.criterion = tradeoff::Criterion::kEnergy;
  EXPECT_THAT(ToText(made), AllOf(Not(HasSubstr(kNote)), HasSubstr("(error of the dissipated")));
}

TEST(MotionRecommendation, OfALimitOfCostSaysWhatIsCheapEnough) {
  MotionRecommendation made = MadeByHand();
  made.request.asked.largest_cost = 7.5;
  made.request.asked.criterion = tradeoff::Criterion::kRmsForce;
  made.request.asked.transient_cycles = 0;
  const std::string text = ToText(made);
  EXPECT_THAT(text, HasSubstr("asked: the most precise within 7.5 ns/sample (rms force error, of "
                              "the peak force)\n\n->"));
  EXPECT_THAT(text, AllOf(HasSubstr("  cheap enough\n"), Not(HasSubstr("meets it"))));
  const auto json = nlohmann::json::parse(ToJson(made));
  EXPECT_EQ(json["largest_cost"], 7.5);
  EXPECT_EQ(json["criterion"], "rms");
}

TEST(MotionRecommendation, SaysThatTheExactIsTheCheapestOrThatNothingMeetsIt) {
  MotionRecommendation made = MadeByHand();
  made.found.after_transient.reset();
  made.found.choice = 4;
  EXPECT_THAT(ToText(made), AllOf(HasSubstr("-> mindlin-dahl by exact: nothing cheaper meets"),
                                  Not(HasSubstr("times as fast")), Not(HasSubstr("transient is")),
                                  Not(HasSubstr("fitted to this"))));
  made.found.choice = 0;
  EXPECT_THAT(
      ToText(made),
      AllOf(HasSubstr(fmt::format("-> coulomb: {}\n", models::FindLimitLaw("coulomb")->title)),
            HasSubstr("10.0 times as fast"), HasSubstr("with Tc = 4.5 N, fitted to")));
  made.found.choice = 2;
  EXPECT_THAT(ToText(made), HasSubstr("0.5 times as fast"));
  made.found.choice.reset();
  const auto json = nlohmann::json::parse(ToJson(made));
  EXPECT_EQ(json["verdict"], "nothing meets the request");
  for (const char* key : {"choice", "command", "cpp", "after_transient"}) {
    EXPECT_TRUE(json[key].is_null()) << key;
  }
  EXPECT_THAT(ToText(made), Not(HasSubstr("command line")));
}

TEST(MotionRecommendation, CommandHasTheMotionAndTheMethod) {
  MotionRecommendation made = MadeByHand();
  const auto command = [&](std::size_t choice) {
    made.found.choice = choice;
    return nlohmann::json::parse(ToJson(made))["command"].get<std::string>();
  };
  DriveRequest& drive = made.request.drive;
  drive.path_unit.clear();
  EXPECT_EQ(command(2),
            "mindahl simulate --model mindlin-dahl --method iwan --steps 16 --sigma 2.5 --alpha "
            "0.75 --slip-force 1.5 --path 'a b.csv'");
  drive.path.clear();
  drive.waveform = "random";
  drive.lambda = 1.25;
  drive.excitation.cycles = 3;
  drive.excitation.samples_per_cycle = 60;
  drive.excitation.growth = 4.5;
  drive.seed = 7;
  EXPECT_EQ(command(3),
            "mindahl simulate --model mindlin-dahl --method dopri5 --tolerance 0.0001 --sigma 2.5 "
            "--alpha 0.75 --slip-force 1.5 --waveform random --lambda 1.25 --cycles 3 "
            "--samples-per-cycle 60 --seed 7");
  drive.waveform = "growing-sine";
  drive.lambda.reset();
  drive.amplitude = 0.5;
  EXPECT_EQ(command(0),
            "mindahl simulate --model coulomb --sigma 9.5 --slip-force 4.5 --waveform "
            "growing-sine --amplitude 0.5 --cycles 3 --samples-per-cycle 60 --growth 4.5");
  EXPECT_THAT(nlohmann::json::parse(ToJson(made))["cpp"].get<std::string>(),
              HasSubstr("Approximation{\"coulomb\", \"\"}, law)"));
  made.found.choice = 2;
  EXPECT_THAT(nlohmann::json::parse(ToJson(made))["cpp"].get<std::string>(),
              HasSubstr("\"iwan\", {.steps = 16}}"));
  made.found.choice = 3;
  EXPECT_THAT(nlohmann::json::parse(ToJson(made))["cpp"].get<std::string>(),
              HasSubstr("\"dopri5\", {.tolerance = 0.0001}}"));
  made.request.displacement = {0.0, 1.0};  // of no file and no waveform
  EXPECT_TRUE(nlohmann::json::parse(ToJson(made))["command"].is_null());
  EXPECT_THAT(ToText(made), Not(HasSubstr("command line")));
}

/// A spring that is not distinguished, Coulomb's law, a law without a fit and the best.
RecordRecommendation PricedByHand() {
  RecordRecommendation priced;
  priced.record = "r.csv";
  const auto add = [&](identification::LawScore score, double cost) {
    priced.laws.scores.push_back(std::move(score));
    priced.cost.push_back(cost);
  };
  add({.model = "spring",
       .law = {2.5, 0.25, 1.5},
       .free_parameters = 2,
       .converged = true,
       .rms = 1.25,
       .misfit = 0.75,
       .delta_aicc = 4.5,
       .likelihood_ratio = 3.5,
       .p_value = 0.0625,
       .told_apart = false},
      3.5);
  add({.model = "coulomb",
       .law = {5.5, 0.5, 6.5},
       .free_parameters = 1,
       .converged = true,
       .rms = 8.5,
       .misfit = 7.5,
       .delta_aicc = 16.5,
       .likelihood_ratio = 18.5,
       .p_value = 1e-120},
      2.25);
  add({.model = "jenkins", .law = {7.0, 0.0, 8.0}, .free_parameters = 4, .p_value = {}}, 4.75);
  add({.model = "mindlin-dahl",
       .law = {9.5, 0.75, 10.5},
       .free_parameters = 5,
       .converged = true,
       .rms = 0.5,
       .p_value = {},
       .told_apart = false},
      12.5);
  priced.laws.best = 3;
  priced.laws.samples = 181;
  priced.laws.effective_samples = 90.25;
  priced.laws.peak_force = 25.0;
  priced.laws.describes_record = true;
  priced.indistinguishable = 5.5;
  return priced;
}

TEST(RecordRecommendation, JsonHasEveryNumberUnderItsName) {
  auto json = nlohmann::json::parse(ToJson(PricedByHand()));
  json.erase("version");
  EXPECT_EQ(json, nlohmann::json::parse(R"({
    "schema": "mindahl.recommend/1",
    "record": {"file": "r.csv", "samples": 181, "effective_samples": 90.25, "peak_force": 25,
               "is_described": true},
    "indistinguishable": 5.5,
    "verdict": "spring: the record does not distinguish it from mindlin-dahl, the best (dAICc = 4.5); it differs from it by 0.75 N rms, 3 % of the peak force, against noise of 0.5 N",
    "law_options": "--model spring --sigma 2.5 --slip-force 1.5",
    "laws": [
      {"model": "spring", "sigma": 2.5, "alpha": null, "slip_force": null, "free_parameters": 2,
       "cost_ns_per_sample": 3.5, "rms": 1.25, "misfit": 0.75, "delta_aicc": 4.5,
       "likelihood_ratio": 3.5, "p_value": 0.0625, "told_apart": false, "best": false,
       "choice": true},
      {"model": "coulomb", "sigma": null, "alpha": null, "slip_force": 6.5, "free_parameters": 1,
       "cost_ns_per_sample": 2.25, "rms": 8.5, "misfit": 7.5, "delta_aicc": 16.5,
       "likelihood_ratio": 18.5, "p_value": 1e-120, "told_apart": true, "best": false,
       "choice": false},
      {"model": "jenkins", "sigma": null, "alpha": null, "slip_force": null, "free_parameters": 4,
       "cost_ns_per_sample": 4.75, "rms": null, "misfit": null, "delta_aicc": null,
       "likelihood_ratio": null, "p_value": null, "told_apart": true, "best": false,
       "choice": false},
      {"model": "mindlin-dahl", "sigma": 9.5, "alpha": 0.75, "slip_force": 10.5,
       "free_parameters": 5, "cost_ns_per_sample": 12.5, "rms": 0.5, "misfit": 0, "delta_aicc": 0,
       "likelihood_ratio": 0, "p_value": null, "told_apart": false, "best": true,
       "choice": false}]})"));
}

TEST(RecordRecommendation, TextHasARowForEachLaw) {
  RecordRecommendation priced = PricedByHand();
  std::string text = ToText(priced);
  EXPECT_THAT(text, StartsWith("r.csv: 181 samples, equivalent to 90 independent ones; peak force "
                               "25 N\nasked: the cheapest law that the record does not distinguish "
                               "from the best (dAICc below 5.5)\n\n-> spring: "));
  EXPECT_THAT(text, HasSubstr("\n   as options of simulate: --model spring --sigma 2.5 "));
  text = WithSingleBlanks(text);
  EXPECT_THAT(text,
              HasSubstr("\n spring 3.50 2 1.25 0.75 4.5 3.5 0.062 not distinguished <- this"));
  EXPECT_THAT(text, HasSubstr("\n coulomb 2.25 1 8.5 7.5 16.5 18.5 <1e-99 distinguished\n"));
  EXPECT_THAT(text, HasSubstr("\n jenkins 4.75 4 no fit\n"));
  EXPECT_THAT(text, HasSubstr("\n mindlin-dahl 12.50 5 0.5 0 0 0 - best\n"));
  priced.choice = 3;
  EXPECT_THAT(ToText(priced), HasSubstr("--sigma 9.5 --slip-force 10.5 --alpha 0.75\n"));
}

}  // namespace
}  // namespace mindahl::request::recommendation_test
