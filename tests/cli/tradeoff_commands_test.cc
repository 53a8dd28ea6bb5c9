
#include <filesystem>
#include <set>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// simulate --method, tradeoff and recommend.
namespace mindahl::cli::tradeoff_commands_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

std::vector<double> Forces(Words words) {
  words.insert(words.begin(),
               {"simulate", "--sigma", "1", "--slip-force", "1", "--amplitude", "1.2"});
  const Outcome outcome = RunCommand(words);
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  std::vector<double> forces;
  const Words lines = Lines(outcome.out);
  for (std::size_t i = 1; i < lines.size(); ++i) forces.push_back(std::stod(Cells(lines[i]).at(2)));
  return forces;
}

double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b.at(i)));
  return largest;
}

TEST(SimulateMethod, StepsRefineEulersAnswerAtFirstOrder) {
  const std::vector<double> exact = Forces({});
  const double coarse = LargestDifference(Forces({"--method", "euler", "--steps", "8"}), exact);
  const double fine = LargestDifference(Forces({"--method", "euler", "--steps", "16"}), exact);
  EXPECT_GT(coarse, 1e-4);  // it is an approximation
  constexpr double kHigherOrders = 0.05;
  EXPECT_NEAR(coarse / fine, 2.0, kHigherOrders);
}

TEST(SimulateMethod, EveryOneOfTheContractComesNearTheClosedForm) {
  const std::vector<double> exact = Forces({});
  constexpr double kNear = 0.02;  // of Tc, at the methods' default resolution
  for (const char* method : {"exact", "euler", "rk4", "dopri5", "iwan"}) {
    EXPECT_LT(LargestDifference(Forces({"--method", method}), exact), kNear) << method;
  }
}

TEST(SimulateMethod, ElementsOfIwanAreItsSteps) {
  const std::vector<double> exact = Forces({});
  const double few = LargestDifference(Forces({"--method", "iwan", "--steps", "16"}), exact);
  const double many = LargestDifference(Forces({"--method", "iwan", "--steps", "64"}), exact);
  constexpr double kOneOrder = 0.15;  // 4 at first order
  EXPECT_NEAR(few / many, 4.0, 4 * kOneOrder);
}

TEST(SimulateMethod, SpringAndCoulombAreModels) {
  const std::vector<double> spring = Forces({"--model", "spring", "--samples-per-cycle", "4"});
  ASSERT_THAT(spring, SizeIs(5));
  EXPECT_EQ(spring[1], 1.2);
  EXPECT_EQ(spring[3], -1.2);
  EXPECT_THAT(Forces({"--model", "coulomb", "--samples-per-cycle", "4"}),
              ElementsAre(0, 1, -1, -1, 1));
}

TEST(SimulateMethod, VaryingLoadScalesTheSlipForce) {
  const TemporaryDirectory directory;
  const std::filesystem::path path =
      directory.Write("path.csv", "x [m],load [N]\n1,10\n100,10\n200,20\n300,5\n");
  const Outcome outcome =
      RunCommand({"simulate", "--sigma", "1", "--slip-force", "3", "--normal-load", "10", "--path",
                  path.string(), "--normal-load-column", "load"});
  ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
  const Words lines = Lines(outcome.out);
  EXPECT_THAT(lines[0], HasSubstr("normal load [N]"));
  const auto force = [&](std::size_t row) { return std::stod(Cells(lines.at(row)).at(2)); };
  // Slipping throughout: T = μN, μ = 0.3.
  constexpr double kRounding = 1e-13;
  EXPECT_NEAR(force(2), 3.0, kRounding);
  EXPECT_NEAR(force(3), 6.0, kRounding);
  EXPECT_NEAR(force(4), 1.5, kRounding);
}

struct Refusal {
  Words words;
  std::string said;
};

TEST(SimulateMethod, RefusesOptionsWithoutEffectNamingTheRemedy) {
  const TemporaryDirectory directory;
  const std::string path = directory.Write("path.csv", "x [m],load [N]\n1,10\n").string();
  for (const Refusal& refusal : {
           Refusal{{"--steps", "3", "--amplitude", "1"}, "choose another method"},
           Refusal{{"--method", "rk4", "--tolerance", "1e-3", "--amplitude", "1"},
                   "--method dopri5"},
           Refusal{{"--method", "rk4", "--steps", "0", "--amplitude", "1"}, "from 1 to"},
           Refusal{{"--method", "iwan", "--model", "dahl", "--amplitude", "1"},
                   "cannot compute model dahl"},
           Refusal{{"--method", "rk4", "--model", "spring", "--amplitude", "1"},
                   "cannot compute --model spring"},
           Refusal{{"--method", "leapfrog", "--amplitude", "1"}, "leapfrog"},
           Refusal{{"--path", path, "--normal-load-column", "load"}, "--normal-load missing"},
           Refusal{{"--path", path, "--normal-load-column", "load", "--normal-load", "1", "--model",
                    "simplified-dahl"},
                   "cannot be used with --model simplified-dahl"},
       }) {
    Words words = {"simulate", "--sigma", "1", "--slip-force", "1"};
    words.insert(words.end(), refusal.words.begin(), refusal.words.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, cli::kBadInput);
    ASSERT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.Errors()[0], HasSubstr(refusal.said));
  }
}

const json& Tradeoff() {
  static const json kStudy = RunCommand({"tradeoff", "--json", "-"}).Json();
  return kStudy;
}

TEST(Tradeoff, StudiesFiveExcitationsWithEveryMethodAndModel) {
  const json& study = Tradeoff();
  EXPECT_EQ(study["schema"], "mindahl.tradeoff/1");
  Words names;
  for (const json& excitation : study["excitations"]) {
    names.push_back(excitation["name"]);
    std::set<std::string> methods;
    std::set<std::string> models;
    for (const json& point : excitation["points"]) {
      models.insert(point["model"].get<std::string>());
      if (!point["method"].is_null()) methods.insert(point["method"].get<std::string>());
      EXPECT_GT(point["cost_ns_per_sample"], 0.0);
    }
    EXPECT_THAT(methods, SizeIs(10));
    EXPECT_THAT(models, SizeIs(6));  // the contact's own, α = 1/3, is Mindlin's
  }
  EXPECT_THAT(names, ElementsAre("micro", "macro", "growing", "random", "nested"));
}

TEST(Tradeoff, ExactIsExactAndOnTheParetoFront) {
  constexpr double kExact = 1e-12;
  for (const json& excitation : Tradeoff()["excitations"]) {
    for (const json& point : excitation["points"]) {
      if (point["model"] != "mindlin" || point["method"] != "exact") continue;
      EXPECT_LT(point["max_force_error"], kExact);
      EXPECT_LT(point["energy_error"], kExact);
      EXPECT_TRUE(point["pareto"]);
    }
  }
}

TEST(Tradeoff, WritesTableCsvAndPlot) {
  const TemporaryDirectory directory;
  const std::filesystem::path csv = directory.path() / "points.csv";
  const std::filesystem::path regions = directory.path() / "regions.csv";
  const std::filesystem::path plot = directory.path() / "points.svg";
  const Outcome outcome = RunCommand({"tradeoff", "--excitation", "micro", "--csv", csv.string(),
                                      "--regions-csv", regions.string(), "--plot", plot.string()});
  ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("* mindlin by exact "), HasSubstr("simplified-dahl"),
                                 HasSubstr("lambda = X/delta_c")));
  EXPECT_THAT(Lines(FileContent(csv)), SizeIs(::testing::Gt(40)));
  EXPECT_THAT(FileContent(regions), HasSubstr("coulomb,1,energy,0.01,"));
  EXPECT_THAT(FileContent(plot), HasSubstr("<svg"));
}

Outcome RecommendOn(const Words& words) {
  Words all = {"recommend", "--sigma", "4.8e8", "--slip-force", "30"};
  all.insert(all.end(), words.begin(), words.end());
  return RunCommand(all);
}

TEST(Recommend, SaysALinearSpringWhenLambdaIsTiny) {
  const Outcome outcome = RecommendOn({"--lambda", "1e-3", "--cycles", "3"});
  EXPECT_EQ(outcome.status, cli::kDone);
  EXPECT_THAT(outcome.out, HasSubstr("-> spring: linear spring"));
  EXPECT_THAT(outcome.out, HasSubstr("of the dissipated energy"));  // what it does not do is said
}

TEST(Recommend, SaysCoulombWhenLambdaIsHuge) {
  EXPECT_THAT(RecommendOn({"--lambda", "1e6", "--cycles", "3"}).out,
              HasSubstr("-> coulomb: Coulomb"));
}

TEST(Recommend, SaysWhenSimplifiedDahlHasSettled) {
  const json result =
      RecommendOn({"--lambda", "0.8", "--cycles", "6", "--tolerance", "1%", "--json", "-"}).Json();
  EXPECT_EQ(result["choice"]["model"], "mindlin");
  ASSERT_FALSE(result["after_transient"].is_null());
  EXPECT_EQ(result["after_transient"]["model"], "simplified-dahl");
  // 11.4, 3.57, 0.719 %: docs/theory.md §3.
  EXPECT_EQ(result["after_transient"]["settles_after_cycles"], 2);
}

TEST(Recommend, CommandThatItGivesComputesWhatItJudged) {
  const TemporaryDirectory directory;
  std::string text = "displacement [m]\n";
  for (int i = 0; i <= 400; ++i) text += std::to_string(4e-4 * std::sin(0.0314159 * i)) + "\n";
  const std::string path = directory.Write("path.csv", text).string();
  const json result = RunCommand({"recommend", "--sigma", "1e4", "--slip-force", "5", "--alpha",
                                  "0.6", "--path", path, "--tolerance", "0.01", "--json", "-"})
                          .Json();
  std::string call = result["command"];
  EXPECT_THAT(call, AllOf(HasSubstr("mindahl simulate --model "), HasSubstr(path)));
  Words words;
  std::istringstream stream(call);
  for (std::string word; stream >> word;) {
    word.erase(std::remove(word.begin(), word.end(), '\''), word.end());
    words.push_back(word);
  }
  words.erase(words.begin());  // "mindahl"
  const Outcome again = RunCommand(words);
  ASSERT_EQ(again.status, cli::kDone) << again.err;
  const Outcome exact = RunCommand({"simulate", "--model", "mindlin-dahl", "--sigma", "1e4",
                                    "--slip-force", "5", "--alpha", "0.6", "--path", path});
  const Words approximate_rows = Lines(again.out);
  const Words exact_rows = Lines(exact.out);
  const double peak = result["excitation"]["peak_force"];
  for (std::size_t i = 1; i < exact_rows.size(); ++i) {
    EXPECT_NEAR(std::stod(Cells(approximate_rows.at(i)).at(2)),
                std::stod(Cells(exact_rows[i]).at(2)), 0.01 * peak);
  }
}

TEST(Recommend, SaysTheSameInEveryRun) {
  const Words words = {"--lambda", "0.8", "--cycles", "3", "--json", "-"};
  EXPECT_EQ(RecommendOn(words).out, RecommendOn(words).out);
}

TEST(Recommend, FitsSimplerModelsToTheExcitation) {
  const json result = RecommendOn({"--lambda", "0.8", "--cycles", "26", "--transient-cycles", "24",
                                   "--samples-per-cycle", "40", "--json", "-"})
                          .Json();
  const auto find = [&](const char* model, bool refitted) -> const json& {
    for (const json& candidate : result["candidates"]) {
      if (candidate["model"] == model && candidate["refitted"].is_null() != refitted) {
        return candidate;
      }
    }
    ADD_FAILURE() << model;
    return result;
  };
  EXPECT_GT(find("dahl", false)["max_force_error"], 0.1);
  // On the steady loop the two laws are one curve (docs/theory.md §6): σ(1 − T*/2Tc)^α, 2Tc − T*,
  // T*/Tc = 1 − 0.2^{3/2}.
  const double peak = 1 - std::pow(0.2, 1.5);
  constexpr double kFound = 1e-8;  // of a start that has fallen to 1e-17 and the digits of a fit
  const json& dahl = find("dahl", true);
  EXPECT_LT(dahl["max_force_error"], kFound);
  EXPECT_TRUE(dahl["meets"]);
  EXPECT_NEAR(dahl["refitted"]["sigma"].get<double>() / (4.8e8 * std::cbrt(1 - peak / 2)), 1,
              kFound);
  EXPECT_NEAR(dahl["refitted"]["slip_force"].get<double>() / (30 * (2 - peak)), 1, kFound);
  EXPECT_FALSE(find("spring", true)["refitted"].contains("slip_force"));
  EXPECT_FALSE(find("coulomb", true)["refitted"].contains("sigma"));
}

TEST(Recommend, CommandOfARefittedModelHasItsParameters) {
  // Jenkins at the contact's own σ and Tc errs by a third, refitted by a tenth.
  const Outcome outcome = RecommendOn({"--lambda", "0.8", "--cycles", "3", "--tolerance", "11%"});
  EXPECT_THAT(outcome.out, HasSubstr("-> jenkins by exact, refitted"));
  EXPECT_THAT(outcome.out, HasSubstr("fitted to this excitation and valid for no other"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("--sigma 480000000")));
}

TEST(Recommend, OfARecordIsTheCheapestLawThatItDoesNotTellFromTheBest) {
  const std::string record = std::string(MINDAHL_SOURCE_DIR) + "/data/partial_slip.csv";
  const Outcome text = RunCommand({"recommend", "--record", record});
  ASSERT_EQ(text.status, cli::kDone) << text.err;
  EXPECT_THAT(text.out,
              HasSubstr("-> mindlin: the record does not distinguish it from mindlin-dahl"));
  const json result = RunCommand({"recommend", "--record", record, "--json", "-"}).Json();
  EXPECT_EQ(result["record"]["samples"], 601);
  double least = std::numeric_limits<double>::infinity();
  double chosen = 0.0;
  int best = 0;
  for (const json& law : result["laws"]) {
    EXPECT_EQ(law["told_apart"], law["delta_aicc"] >= result["indistinguishable"]) << law;
    if (!law["told_apart"]) least = std::min(least, law["cost_ns_per_sample"].get<double>());
    if (law["choice"]) chosen = law["cost_ns_per_sample"];
    if (law["best"]) ++best;
  }
  constexpr double kSameCost = 1.1;
  EXPECT_LE(chosen, kSameCost * least);
  EXPECT_EQ(best, 1);
  EXPECT_THAT(result["law_options"].get<std::string>(), HasSubstr("--model mindlin --sigma 4.8"));
}

TEST(Recommend, WarnsOfAContactThatIsDoubtful) {
  const Outcome outcome =
      RunCommand({"recommend", "--compliance", "0.2", "--contact-radius", "1e-4", "--normal-load",
                  "50", "--friction", "6", "--lambda", "0.8", "--cycles", "2"});
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("mindahl recommend: warning: friction coefficient"));
}

TEST(Recommend, ARecordThatNoLawDescribesEstablishesNothing) {
  // A force that is the same at either end of the motion.
  const TemporaryDirectory directory;
  std::string text = "x [m],F [N]\n";
  for (int i = 0; i <= 400; ++i) {
    const double x = std::sin(0.0314159 * i);
    text += std::to_string(x) + "," +
            std::to_string(std::copysign(1.0, std::cos(0.0314159 * i)) + 3 * x * x +
                           0.01 * std::sin(71.0 * i)) +
            "\n";
  }
  const Outcome outcome =
      RunCommand({"recommend", "--record", directory.Write("odd.csv", text).string()});
  EXPECT_EQ(outcome.status, cli::kNotEstablished);
  EXPECT_THAT(outcome.err, HasSubstr("none of these laws describes the record"));
}

TEST(Recommend, ARecordExcludesWhatItBringsItself) {
  const std::string record = SampleRecord();
  for (const Words& words :
       {Words{"--sigma", "1"}, Words{"--tolerance", "2%"}, Words{"--lambda", "0.8"},
        Words{"--path", record}, Words{"--cost", "3"}}) {
    Words all = {"recommend", "--record", record};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = RunCommand(all);
    EXPECT_EQ(outcome.status, cli::kBadInput);
    ASSERT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.Errors()[0], HasSubstr("--record excludes " + words[0]));
  }
  EXPECT_EQ(RunCommand({"recommend", "--record", "/no/such.csv"}).status, cli::kBadInput);
}

TEST(Recommend, CostIsTheLimitTheOtherWayRound) {
  const json result =
      RecommendOn({"--lambda", "0.8", "--cycles", "3", "--cost", "1e6", "--json", "-"}).Json();
  // Whatever the clock: nothing allowed is more precise than the choice.
  for (const json& candidate : result["candidates"]) {
    EXPECT_GE(candidate["max_force_error"], result["choice"]["max_force_error"]);
  }
}

TEST(Recommend, ExitsWithThreeWhenNothingIsCheapEnough) {
  const Outcome outcome = RecommendOn({"--lambda", "0.8", "--cost", "1e-6"});
  EXPECT_EQ(outcome.status, cli::kNotEstablished);
  EXPECT_THAT(outcome.out, HasSubstr("nothing meets the request"));
}

TEST(Recommend, RefusesAToleranceThatIsNone) {
  for (const char* tolerance : {"0", "-1%", "one", "1%%", "inf", ""}) {
    const Outcome outcome = RecommendOn({"--lambda", "0.8", "--tolerance", tolerance});
    EXPECT_EQ(outcome.status, cli::kBadInput) << tolerance;
    ASSERT_THAT(outcome.Errors(), SizeIs(1));
    EXPECT_THAT(outcome.Errors()[0], HasSubstr("--tolerance")) << tolerance;
  }
}

}  // namespace
}  // namespace mindahl::cli::tradeoff_commands_test
