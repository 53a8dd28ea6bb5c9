#include "mindahl/request/tradeoff.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "support/prelude.h"

// These tests concern the sentences on a study whose points are set by hand.
namespace mindahl::request::tradeoff_test {
namespace {

using tradeoff::WorkPrecision;

WorkPrecision Point(std::string model, std::string method, double cost, double max_force) {
  return {
      .approximation = {std::move(model), std::move(method)},
      .precision = {.max_force = max_force, .rms_force = max_force / 2, .energy = max_force / 4},
      .cost = cost};
}

/// Jenkins' model and the exact law along one drive.
Tradeoff Study() {
  Tradeoff study{.law = {4e7, 1.0 / 3, 40.0}, .tolerance = 0.1};
  study.excitations.push_back(
      {.name = "micro",
       .title = "micro-slip",
       .samples = 1001,
       .points = {Point("jenkins", "exact", 3.0, 0.08), Point("mindlin", "exact", 12.0, 0.0)},
       .cheapest = 0,
       .cheapest_with_energy = 1});
  study.excitations[0].points[0].is_on_front = true;
  return study;
}

void Ignore(std::string_view) {}

TEST(MakeTradeoff, SaysWhatIsDoubtfulOfTheContact) {
  TradeoffRequest request;
  request.law.contact.known = {
      .normal_load = 10.0, .contact_radius = 1e-3, .tangential_compliance = 2e-11};
  request.law.contact.friction_coefficient = 6.0;
  request.displacement = {0.0, 1e-6};
  std::vector<std::string> doubts;
  MakeTradeoff(request, [&](std::string_view doubt) { doubts.emplace_back(doubt); });
  EXPECT_THAT(doubts, ::testing::Contains(::testing::HasSubstr("mu = 6 is above 5")));
}

TEST(MakeTradeoff, IsOfThePapersContactUnlessAnotherIsGiven) {
  TradeoffRequest request;
  request.displacement = {0.0, 1e-6, -1e-6};
  request.path_name = "p.csv";
  const Tradeoff made = MakeTradeoff(request, Ignore);
  EXPECT_DOUBLE_EQ(made.law.slip_force, 0.3 * 100);                        // mu N
  EXPECT_DOUBLE_EQ(made.law.tangential_stiffness, 8 * 0.0027 / 4.42e-11);  // 8a/G*
  EXPECT_DOUBLE_EQ(made.law.shape_exponent, 1.0 / 3);
  EXPECT_EQ(made.excitations[0].name, "path");
  EXPECT_EQ(made.excitations[0].title, "p.csv");
  EXPECT_EQ(made.excitations[0].samples, 3U);
  EXPECT_THAT(ExcitationNames(), ElementsAre("micro", "macro", "growing", "random", "nested"));
}

TEST(TradeoffText, StatesTheCheapestAndEveryPoint) {
  const std::string text = ToText(Study());
  EXPECT_THAT(
      text,
      AllOf(
          HasSubstr("sigma = 4e+07 N/m, alpha = 0.333333, Tc = 40 N"),
          HasSubstr("micro-slip: 1001 samples\n"
                    "cheapest within 10 % of the peak force: jenkins by exact, 3.0 ns/sample, 4.0 "
                    "times as fast as mindlin by exact\n"
                    "and of the dissipated energy: mindlin by exact, 12.0 ns/sample: nothing "
                    "cheaper is within it\n"),
          HasSubstr("\n* jenkins by exact                           3.00   8.0e-02  "
                    "4.0e-02  2.0e-02\n"),
          HasSubstr("\n  mindlin by exact  ")));
}

TEST(TradeoffCsv, HasARowForEveryPoint) {
  Tradeoff study = Study();
  study.excitations[0].points[1].approximation = {
      "mindlin-dahl", "dopri5", {.steps = 3, .tolerance = 0.5}};
  const std::string points = PointsCsv(study);
  EXPECT_THAT(points, HasSubstr("\nmicro,jenkins,exact,,,3.0,0.08,0.04,0.02,1\n"));
  EXPECT_THAT(points, HasSubstr("\nmicro,mindlin-dahl,dopri5,3,0.5,12.0,0.0,0.0,0.0,0\n"));
}

TEST(TradeoffJson, HasEveryNumberUnderItsName) {
  Tradeoff study = Study();
  WorkPrecision& spring = study.excitations[0].points.emplace_back(Point("spring", "", 2.5, 0.5));
  spring.precision.energy.reset();
  auto json = nlohmann::json::parse(ToJson(study));
  nlohmann::json& scene = json["excitations"][0];
  ASSERT_EQ(scene["points"].size(), 3U);
  EXPECT_EQ(scene["points"][2], nlohmann::json::parse(R"({
    "model": "spring", "method": null, "steps": null, "tolerance": null, "cost_ns_per_sample": 2.5,
    "max_force_error": 0.5, "rms_force_error": 0.25,
    "energy_error": null, "pareto": false})"));
  EXPECT_EQ(scene["cheapest"], scene["points"][0]);
  EXPECT_EQ(scene["cheapest_with_energy"], scene["points"][1]);
  json.erase("version");
  json.erase("excitations");
  EXPECT_EQ(json,
            (nlohmann::json{{"schema", "mindahl.tradeoff/1"},
                            {"law", {{"sigma", 4e7}, {"alpha", 1.0 / 3}, {"slip_force", 40.0}}},
                            {"tolerance", 0.1}}));
}

TEST(TradeoffPlot, HasAPanelAnExcitationAndOneLegendAndAnExactOneAboveNought) {
  Tradeoff study = Study();
  study.excitations.push_back(study.excitations[0]);
  study.excitations[1].title = "macro-slip";
  const io::Plot plot = ToPlot(study);
  ASSERT_EQ(plot.panels.size(), 2U);
  EXPECT_TRUE(plot.panels[0].log_x && plot.panels[0].log_y);
  EXPECT_EQ(plot.panels[0].title, "micro-slip");
  EXPECT_EQ(plot.panels[1].series[0].label, "");
  const io::PlotSeries& jenkins = plot.panels[0].series[0];
  EXPECT_EQ(jenkins.label, "jenkins");
  EXPECT_EQ(jenkins.style, io::PlotStyle::kMarkers);
  EXPECT_EQ(jenkins.x, std::vector{3.0});
  EXPECT_EQ(jenkins.y, std::vector{0.08});
  const io::PlotSeries& exact = plot.panels[0].series[1];
  EXPECT_EQ(exact.label, "exact");
  EXPECT_EQ(exact.style, io::PlotStyle::kLineAndPoints);
  EXPECT_GT(exact.y[0], 0.0);
}

}  // namespace
}  // namespace mindahl::request::tradeoff_test
