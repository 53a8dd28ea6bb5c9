#include "mindahl/request/tradeoff.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "request/json.h"
#include "support/prelude.h"

// These tests concern the sentences on a study whose points are set by hand.
namespace mindahl::request::tradeoff_test {
namespace {

using tradeoff::Criterion;
using tradeoff::WorkPrecision;

WorkPrecision Point(std::string model, std::string method, double cost, double max_force) {
  return {
      .approximation = {std::move(model), std::move(method)},
      .precision = {.max_force = max_force, .rms_force = max_force / 2, .energy = max_force / 4},
      .cost = cost,
      .measured_cost = 2 * cost};
}

/// Jenkins' model and the exact law along one drive, and where each serves.
Tradeoff Study() {
  Tradeoff study;
  study.law = {4e7, 1.0 / 3, 40.0};
  study.studied.tolerances = {0.01, 0.05};
  study.excitations.push_back(
      {.name = "micro",
       .title = "micro-slip",
       .samples = 1001,
       .floor = {.memory = 0.5, .arithmetic = 1.5},
       .points = {Point("jenkins", "exact", 3.0, 0.08), Point("mindlin", "exact", 12.0, 0.0)},
       .front = {true, false}});
  const double least = study.studied.least_lambda;
  const double greatest = study.studied.greatest_lambda;
  const auto add = [&](std::size_t cycle, double tolerance,
                       std::vector<tradeoff::LambdaRange> ranges) {
    study.regions.push_back({"jenkins", cycle, Criterion::kMaxForce, tolerance, std::move(ranges)});
  };
  add(1, 0.01, {{least, 0.02}, {1.25, greatest}});
  add(1, 0.05, {{0.25, 0.75}});
  add(2, 0.01, {{least, 0.02}, {1.25, greatest}});
  add(2, 0.05, {{0.25, 0.75}});
  add(3, 0.01, {});
  add(3, 0.05, {{least, greatest}});
  return study;
}

TEST(MakeTradeoff, SaysWhatIsDoubtfulOfTheContactBeforeItBegins) {
  TradeoffRequest request;
  request.law.contact.known = {
      .normal_load = 10.0, .contact_radius = 1e-3, .tangential_compliance = 2e-11};
  request.law.contact.friction_coefficient = 6.0;
  std::vector<std::string> doubts;
  struct Began {};
  EXPECT_THROW(MakeTradeoff(
                   request, [&](std::string_view doubt) { doubts.emplace_back(doubt); },
                   [](std::string_view) { throw Began(); }),
               Began);
  EXPECT_THAT(doubts, ::testing::Contains(::testing::HasSubstr("mu = 6 is above 5")));
}

std::vector<std::string> LinesWith(const std::string& text, std::string_view words) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.find(words) != std::string::npos) lines.push_back(line);
  }
  return lines;
}

TEST(TradeoffText, SaysRangesByTheirEndsWithinWhatWasStudied) {
  const std::vector<std::string> rows = LinesWith(ToText(Study()), "jenkins   ");
  // The points' row, then cycles 1 and 3: the second is like the first.
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_THAT(rows[0],
              AllOf(HasSubstr(" 1 force"), HasSubstr("< 0.02, > 1.25"), HasSubstr("0.25 … 0.75")));
  EXPECT_THAT(rows[1], AllOf(HasSubstr(" 3 force"), HasSubstr(" -  "), HasSubstr(" all ")));
  EXPECT_LT(rows[0].find("1.25"), rows[0].find("0.25"));  // in the order of the tolerances
}

TEST(TradeoffText, LeavesOutACycleLikeTheOneBeforeOfTheSameModelAndCriterion) {
  Tradeoff study = Study();
  study.regions.clear();
  // Each row is that of the criterion before it, or of the model before it.
  const auto add = [&](const char* model, std::size_t cycle, Criterion criterion, double from) {
    for (const double tolerance : study.studied.tolerances) {
      study.regions.push_back({model, cycle, criterion, tolerance, {{from, 0.5}}});
    }
  };
  for (const char* model : {"jenkins", "masing"}) {
    for (const std::size_t cycle : {1U, 2U, 3U}) {
      for (const Criterion criterion : {Criterion::kMaxForce, Criterion::kEnergy}) {
        add(model, cycle, criterion, cycle == 3 ? 0.25 : 0.125);
      }
    }
  }
  for (const char* model : {"  jenkins   ", "  masing   "}) {
    const std::vector<std::string> rows = LinesWith(ToText(study), model);
    ASSERT_EQ(rows.size(), 4U) << model;
    EXPECT_THAT(rows[0], AllOf(HasSubstr(" 1 force"), HasSubstr("0.125 … 0.5")));
    EXPECT_THAT(rows[1], AllOf(HasSubstr(" 1 energy"), HasSubstr("0.125 … 0.5")));
    EXPECT_THAT(rows[2], AllOf(HasSubstr(" 3 force"), HasSubstr("0.25 … 0.5")));
    EXPECT_THAT(rows[3], AllOf(HasSubstr(" 3 energy"), HasSubstr("0.25 … 0.5")));
  }
}

TEST(TradeoffText, StatesThePointsWithTheirCostOverTheFloor) {
  const std::string text = ToText(Study());
  EXPECT_THAT(text, AllOf(HasSubstr("sigma = 4e+07 N/m, alpha = 0.333333, Tc = 40 N"),
                          HasSubstr("micro-slip: 1001 samples"),
                          HasSubstr("0.50 ns/sample for memory, 1.50 with")));
  const std::vector<std::string> rows = LinesWith(text, "jenkins by exact");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_THAT(rows[0], StartsWith("* jenkins"));
  EXPECT_THAT(LinesWith(text, "mindlin by exact")[0], StartsWith("  mindlin"));
  std::istringstream cells(rows[0].substr(rows[0].find("exact") + 5));
  double cost = 0.0;
  double measured = 0.0;
  double over_floor = 0.0;
  double max_force = 0.0;
  double rms_force = 0.0;
  double energy = 0.0;
  cells >> cost >> measured >> over_floor >> max_force >> rms_force >> energy;
  EXPECT_EQ(cost, 3.0);
  EXPECT_EQ(measured, 6.0);
  EXPECT_NEAR(over_floor, 3.0 / tradeoff::ModelledCostFloor().arithmetic, 0.05);  // one decimal
  EXPECT_EQ(max_force, 0.08);
  EXPECT_EQ(rms_force, 0.04);
  EXPECT_EQ(energy, 0.02);
}

TEST(TradeoffCsv, HasARowForEveryPointAndEveryRange) {
  const std::string points = PointsCsv(Study());
  EXPECT_THAT(points, HasSubstr("\nmicro,jenkins,exact,,,3,6.0,"));
  EXPECT_THAT(points, HasSubstr(",0.08,0.04,0.02,1,,,\n"));
  EXPECT_THAT(points, HasSubstr("\nmicro,mindlin,exact,,,12,24.0,"));
  EXPECT_THAT(points, HasSubstr(",0,0,0.0,0,,,\n"));
  const std::string regions = RegionsCsv(Study());
  EXPECT_EQ(std::ranges::count(regions, '\n'), 1 + 2 + 1 + 2 + 1 + 1);
  EXPECT_THAT(regions, HasSubstr("\njenkins,2,force,0.05,0.25,0.75\n"));
}

TEST(TradeoffJson, HasWhatTheStudyHas) {
  const auto json = nlohmann::json::parse(ToJson(Study()));
  EXPECT_EQ(json["law"]["sigma"], 4e7);
  EXPECT_EQ(json["law"]["slip_force"], 40.0);
  const auto& scene = json["excitations"][0];
  EXPECT_EQ(scene["samples"], 1001);
  EXPECT_TRUE(scene["points"][0]["pareto"]);
  EXPECT_FALSE(scene["points"][1]["pareto"]);
  EXPECT_EQ(scene["points"][0]["measured_ns_per_sample"], 6.0);
  EXPECT_EQ(scene["points"][0]["energy_error"], 0.02);
  ASSERT_EQ(json["model_regions"].size(), 6U);
  EXPECT_EQ(json["model_regions"][1]["lambda"][0], (std::vector<double>{0.25, 0.75}));
  EXPECT_EQ(json["model_regions"][0]["lambda"][1][0], 1.25);
}

TEST(TradeoffPlot, DrawsErrorsOverCostsAndAnExactOneAboveNought) {
  const io::Plot plot = ToPlot(Study());
  ASSERT_EQ(plot.panels.size(), 1U);
  EXPECT_TRUE(plot.panels[0].log_x && plot.panels[0].log_y);
  ASSERT_EQ(plot.panels[0].series.size(), 2U);
  const io::PlotSeries& jenkins = plot.panels[0].series[0];
  EXPECT_EQ(jenkins.label, "jenkins");
  EXPECT_EQ(jenkins.x, std::vector{3.0});
  EXPECT_EQ(jenkins.y, std::vector{0.08});
  const io::PlotSeries& exact = plot.panels[0].series[1];
  EXPECT_EQ(exact.label, "exact");
  EXPECT_EQ(exact.x, std::vector{12.0});
  EXPECT_GT(exact.y[0], 0.0);
}

TEST(TradeoffJson, HasEveryNumberUnderItsName) {
  Tradeoff study = Study();
  study.regions.erase(study.regions.begin() + 2, study.regions.end());
  study.regions[1].criterion = Criterion::kEnergy;
  WorkPrecision& spring = study.excitations[0].points.emplace_back(Point("spring", "", 2.5, 0.5));
  spring.approximation.law = models::BranchLaw{6.5, 0.25, 7.5};
  spring.precision.energy.reset();
  spring.measured_cost.reset();
  spring.operations.Add(methods::Operation::kSample, 4);
  spring.operations.Add(methods::Operation::kLinear, 3);
  study.excitations[0].front.push_back(true);
  auto json = nlohmann::json::parse(ToJson(study));
  EXPECT_EQ(json["excitations"][0]["points"].size(), 3U);
  EXPECT_EQ(json["excitations"][0]["points"][2], nlohmann::json::parse(R"({
    "model": "spring", "method": null, "steps": null, "tolerance": null,
    "refitted": {"sigma": 6.5}, "cost_ns_per_sample": 2.5, "measured_ns_per_sample": null,
    "operations_per_sample": {"sample": 1, "linear": 0.75}, "max_force_error": 0.5,
    "rms_force_error": 0.25, "energy_error": null, "pareto": true})"));
  json["excitations"][0].erase("points");
  json.erase("version");
  const double least = study.studied.least_lambda;
  const double greatest = study.studied.greatest_lambda;
  const nlohmann::json whole = {
      {"schema", "mindahl.tradeoff/1"},
      {"law", {{"sigma", 4e7}, {"alpha", 1.0 / 3}, {"slip_force", 40.0}}},
      {"excitations",
       {{{"name", "micro"},
         {"samples", 1001},
         {"cost_floor", {{"memory_ns_per_sample", 0.5}, {"arithmetic_ns_per_sample", 1.5}}}}}},
      {"model_regions",
       {{{"model", "jenkins"},
         {"cycle", 1},
         {"criterion", "force"},
         {"tolerance", 0.01},
         {"lambda", {{least, 0.02}, {1.25, greatest}}}},
        {{"model", "jenkins"},
         {"cycle", 1},
         {"criterion", "energy"},
         {"tolerance", 0.05},
         {"lambda", nlohmann::json::array({nlohmann::json::array({0.25, 0.75})})}}}}};
  EXPECT_EQ(json, whole);
}

TEST(TradeoffCsv, HasThePointsOwnParametersAndTheirCostOverTheFloor) {
  Tradeoff study = Study();
  std::vector<WorkPrecision>& points = study.excitations[0].points;
  points[0].approximation.law = models::BranchLaw{6.5, 0.25, 7.5};
  points[1].approximation = {"mindlin-dahl", "dopri5", {.steps = 3, .tolerance = 0.5}};
  const double floor = tradeoff::ModelledCostFloor().arithmetic;
  const std::string csv = PointsCsv(study);
  const std::string row = csv.substr(csv.find("\nmicro,jenkins"));
  EXPECT_THAT(row, StartsWith("\nmicro,jenkins,exact,,,3,6.0," + fmt::format("{}", 3 / floor) +
                              ",0.08,0.04,0.02,1,6.5,0.0,7.5\n"));
  EXPECT_THAT(csv, HasSubstr("\nmicro,mindlin-dahl,dopri5,3,0.5,12,24.0,"));
  EXPECT_THAT(RegionsCsv(study), StartsWith("model,cycle,criterion,tolerance [-],lambda from "
                                            "[-],lambda to [-]\njenkins,1,force,0.01,"));
}

TEST(TradeoffPlot, HasAPanelAnExcitationAndOneLegend) {
  Tradeoff study = Study();
  study.excitations[0].points[0].approximation.law = models::BranchLaw{6.5, 0.25, 7.5};
  study.excitations.push_back(study.excitations[0]);
  study.excitations[1].title = "macro-slip";
  study.excitations[1].points[0].approximation.law.reset();
  study.excitations[1].points.push_back(study.excitations[1].points.back());
  for (const std::size_t scenes : {2U, 3U}) {
    if (scenes == 3) study.excitations.insert(study.excitations.begin(), study.excitations[0]);
    const io::Plot plot = ToPlot(study);
    ASSERT_EQ(plot.panels.size(), scenes);
    EXPECT_EQ(plot.columns, 2);
    EXPECT_EQ(plot.width, 1500);
    EXPECT_EQ(plot.height, 60 + 460 * (scenes == 2 ? 1 : 2));
    EXPECT_EQ(plot.panels.front().title, "micro-slip");
    EXPECT_EQ(plot.panels.back().title, "macro-slip");
    EXPECT_EQ(plot.panels.front().series[0].label, "");
    EXPECT_EQ(plot.panels.back().series[0].label, "jenkins");
    EXPECT_EQ(plot.panels.back().series[1].label, "exact");
    EXPECT_THAT(plot.panels.back().series[1].x, ElementsAre(12.0, 12.0));
    EXPECT_EQ(plot.panels.back().series[0].style, io::PlotStyle::kMarkers);
    EXPECT_EQ(plot.panels.back().series[1].style, io::PlotStyle::kLineAndPoints);
  }
  study.excitations.resize(1);
  const io::Plot alone = ToPlot(study);
  EXPECT_EQ(alone.panels[0].series[0].label, "jenkins refitted");
  EXPECT_EQ(alone.columns, 1);
  EXPECT_EQ(alone.width, 900);
  EXPECT_EQ(alone.height, 520);
}

TEST(RefittedParameters, AreThoseThatTheLawHas) {
  const auto words = [](const char* model) {
    return RefittedParameters({model, "exact", {}, models::BranchLaw{2.5, 0.25, 1.5}});
  };
  EXPECT_EQ(words("spring"), "sigma = 2.5 N/m");
  EXPECT_EQ(words("coulomb"), "Tc = 1.5 N");
  EXPECT_EQ(words("dahl"), "sigma = 2.5 N/m and Tc = 1.5 N");
}

TEST(MakeTradeoff, IsOfThePapersContactUnlessAnotherIsGiven) {
  TradeoffRequest request;
  request.displacement = {0.0, 1e-6, -1e-6};
  request.path_name = "p.csv";
  const Tradeoff made = MakeTradeoff(
      request, [](std::string_view) {}, [](std::string_view) {});
  EXPECT_DOUBLE_EQ(made.law.slip_force, 0.3 * 100);                        // mu N
  EXPECT_DOUBLE_EQ(made.law.tangential_stiffness, 8 * 0.0027 / 4.42e-11);  // 8a/G*
  EXPECT_DOUBLE_EQ(made.law.shape_exponent, 1.0 / 3);
}

TEST(MakeTradeoff, MeasuresThePathOrTheExcitationsThatAreChosen) {
  TradeoffRequest request;
  request.law.sigma = 4e7;
  request.law.slip_force = 40.0;
  request.law.alpha = 1.0;  // slips nowhere: no regions, and three elastic limits are λ = 1
  request.displacement = {0.0, 1e-6, 2e-6, -2e-6, 2e-6};
  request.path_name = "p.csv";
  std::vector<std::string> progress;
  const Tradeoff made = MakeTradeoff(
      request, [](std::string_view) {},
      [&](std::string_view text) { progress.emplace_back(text); });
  ASSERT_EQ(made.excitations.size(), 1U);
  EXPECT_EQ(made.excitations[0].name, "path");
  EXPECT_EQ(made.excitations[0].title, "p.csv");
  EXPECT_EQ(made.excitations[0].samples, 5U);
  EXPECT_EQ(made.excitations[0].front.size(), made.excitations[0].points.size());
  EXPECT_TRUE(made.regions.empty());
  EXPECT_EQ(progress.size(), 2U);
  EXPECT_EQ(made.law.shape_exponent, 1.0);
  EXPECT_THAT(ExcitationNames(), ElementsAre("micro", "macro", "growing", "random", "nested"));
}

}  // namespace
}  // namespace mindahl::request::tradeoff_test
