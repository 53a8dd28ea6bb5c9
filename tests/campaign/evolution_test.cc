#include "mindahl/campaign/evolution.h"

#include "support/prelude.h"

namespace mindahl::campaign::evolution_test {
namespace {

/// Falls by a tenth after its 60th cycle.
Evolution Step(bool has_errors) {
  Evolution evolution{.name = "sigma", .unit = "N/m", .has_errors = has_errors};
  for (std::size_t cycle = 1; cycle <= 100; ++cycle) {
    const double ripple = cycle % 2 == 0 ? 1e5 : -1e5;
    evolution.course.Add(cycle, (cycle <= 60 ? 5e7 : 4.5e7) + ripple, 1 / (2e5 * 2e5));
  }
  evolution.description = FindChanges(evolution.course);
  return evolution;
}

TEST(Evolution, DrawsTimeHistoryBandAndChange) {
  const std::vector<Evolution> evolutions = {Step(/*has_errors=*/true)};
  const std::vector<io::PlotPanel> panels = EvolutionPanels(evolutions);
  ASSERT_THAT(panels, SizeIs(1));
  EXPECT_EQ(panels[0].y_label, "sigma [N/µm]");
  const io::PlotSeries& course = panels[0].series[0];
  ASSERT_THAT(course.x, SizeIs(100));
  constexpr double kQuantile95 = 1.959963984540054;
  constexpr double kRounding = 1e-9;
  EXPECT_NEAR(course.upper[9] - course.y[9], kQuantile95 * 0.2, kRounding);
  EXPECT_NEAR(course.y[9], 50.1, kRounding);
  ASSERT_THAT(panels[0].marks, SizeIs(1));
  EXPECT_EQ(panels[0].marks[0].x, 61);
  EXPECT_THAT(panels[0].marks[0].label, HasSubstr("step"));
}

TEST(Evolution, WithoutErrorsHasTheLeastAndGreatestOfItsCyclesForABand) {
  Evolution evolution{.name = "half_gap", .unit = "N"};
  // Two bins' worth more than there are bins: each then stands for two cycles.
  for (std::size_t cycle = 1; cycle <= 2 * Course::kMostBins; ++cycle) {
    evolution.course.Add(cycle, cycle % 2 == 0 ? 11.0 : 10.0);
  }
  evolution.description = FindChanges(evolution.course);
  const std::vector<Evolution> evolutions = {evolution};
  const io::PlotSeries course = EvolutionPanels(evolutions)[0].series[0];
  ASSERT_THAT(course.x, SizeIs(Course::kMostBins));
  for (std::size_t k = 0; k < course.x.size(); ++k) {
    EXPECT_EQ(course.lower[k], 10.0);
    EXPECT_EQ(course.upper[k], 11.0);
  }
}

TEST(Evolution, HasTheBandOfOneCycleWhereAPointStandsForTwo) {
  constexpr double kError = 2e5;
  Evolution evolution{.name = "sigma", .unit = "N/m", .has_errors = true};
  for (std::size_t cycle = 1; cycle <= 2 * Course::kMostBins; ++cycle) {
    evolution.course.Add(cycle, 5e7, 1 / (kError * kError));
  }
  const std::vector<Evolution> evolutions = {evolution};
  const io::PlotSeries course = EvolutionPanels(evolutions)[0].series[0];
  ASSERT_THAT(course.x, SizeIs(Course::kMostBins));
  constexpr double kQuantile95 = 1.959963984540054;
  constexpr double kRounding = 1e-9;
  for (std::size_t k = 0; k < course.x.size(); ++k) {  // [N/µm]
    EXPECT_NEAR(course.upper[k] - course.y[k], kQuantile95 * 1e-6 * kError, kRounding);
    EXPECT_NEAR(course.y[k] - course.lower[k], kQuantile95 * 1e-6 * kError, kRounding);
  }
}

TEST(Evolution, OfOneCycleIsNoPicture) {
  Evolution evolution{.name = "sigma", .unit = "N/m"};
  evolution.course.Add(1, 5e7);
  const std::vector<Evolution> evolutions = {evolution};
  EXPECT_THAT(EvolutionPanels(evolutions), SizeIs(0));
  EXPECT_THROW(EvolutionPlot(evolutions, "", ""), InvalidArgument);
}

TEST(Evolution, DrawsEachSegmentAndNamesEachChange) {
  Evolution evolution{.name = "alpha", .unit = "-"};
  for (std::size_t cycle = 1; cycle <= 30; ++cycle) evolution.course.Add(cycle, 0.25);
  evolution.description.stretches = {
      {.first_cycle = 1, .last_cycle = 11, .at_start = 5.0, .at_end = 3.0, .time_constant = 10.0},
      {.first_cycle = 12, .last_cycle = 30, .at_start = 2.0, .at_end = 1.0, .time_constant = {}}};
  evolution.description.changes = {{.kind = ChangeKind::kEndOfRunningIn, .cycle = 12},
                                   {.kind = ChangeKind::kTransition, .cycle = 15},
                                   {.kind = ChangeKind::kBend, .cycle = 20}};
  std::vector<Evolution> evolutions = {evolution, evolution};
  evolutions[1].name = "half_gap";
  evolutions[1].unit = "N";
  const io::Plot plot = EvolutionPlot(evolutions, "title", "subtitle");
  EXPECT_EQ(plot.title, "title");
  EXPECT_EQ(plot.subtitle, "subtitle");
  EXPECT_EQ(plot.height, 3 * 230);
  ASSERT_THAT(plot.panels, SizeIs(2));
  EXPECT_EQ(plot.panels[0].x_label, "");
  EXPECT_EQ(plot.panels[1].x_label, "cycle");
  EXPECT_EQ(plot.panels[0].y_label, "alpha");
  EXPECT_EQ(plot.panels[1].y_label, "half_gap [mN]");
  const io::PlotPanel& panel = plot.panels[0];
  ASSERT_THAT(panel.series, SizeIs(3));
  EXPECT_EQ(panel.series[0].label, "cycles, least and greatest");
  EXPECT_EQ(panel.series[1].label, "stretches");
  EXPECT_EQ(panel.series[2].label, "");
  // A curve in forty steps: half way of 10 cycles, 5 − 2·(1 − e^−½)/(1 − e^−1).
  ASSERT_THAT(panel.series[1].x, SizeIs(41));
  EXPECT_NEAR(panel.series[1].x[20], 6.0, 1e-12);
  EXPECT_NEAR(panel.series[1].y[20], 5 - 2 * std::expm1(-0.5) / std::expm1(-1.0), 1e-12);
  EXPECT_THAT(panel.series[2].x, ElementsAre(12, 30));
  EXPECT_THAT(panel.series[2].y, ElementsAre(2, 1));
  EXPECT_NEAR(plot.panels[1].series[2].y[0], 2000.0, 1e-9);  // [mN]
  ASSERT_THAT(panel.marks, SizeIs(3));
  EXPECT_EQ(panel.marks[0].label, "running-in ends, 12");
  EXPECT_EQ(panel.marks[1].label, "step, 15");
  EXPECT_EQ(panel.marks[2].label, "other rate, 20");
  EXPECT_EQ(panel.marks[2].x, 20.0);
}

}  // namespace
}  // namespace mindahl::campaign::evolution_test
