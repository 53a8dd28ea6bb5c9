#include "mindahl/campaign/pages.h"

#include "mindahl/campaign/evolution.h"
#include "support/page_text.h"
#include "support/prelude.h"

namespace mindahl::campaign::pages_test {
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

TestSummary SummaryOf(Evolution evolution) {
  return {.files = {"<script>.csv"},
          .cycles = 100,
          .samples = 20'000,
          .fits = 100,
          .dissipated = 0.25,
          .flags = {{.name = "alpha_open", .meaning = "not determined", .cycles = 7}},
          .evolutions = {std::move(evolution)},
          .changes = {"sigma [N/m]: at cycle 61 a step"}};
}

TEST(TestPage, ReportsSharedAlphaAndSourceOfEnergies) {
  TestSummary test = SummaryOf(Step(/*has_errors=*/true));
  EXPECT_THAT(ToPage(test), Not(HasSubstr("shared")));
  EXPECT_THAT(ToPage(test), Not(HasSubstr("counting")));
  PooledValue alpha;
  alpha.Add(0.3, 0.01);
  alpha.Add(0.4, 0.01);
  test.shared_alpha = alpha;
  test.energy_counts = {.measured = 95, .replaced = 3, .left_out = 2};
  const std::string page = ToPage(test);
  EXPECT_THAT(page, HasSubstr("shared alpha 0.35 ± 0.05, from 2 cycles"));
  EXPECT_THAT(
      page,
      HasSubstr("counting 3 unclosed cycles by the median of those before them and 2 as zero"));
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

TEST(TestPage, SaysWhatChangedAndEscapesItsFiles) {
  const std::string page = testing::Unbroken(ToPage(SummaryOf(Step(true))));
  EXPECT_THAT(page, HasSubstr("<h1>&lt;script&gt;.csv: 100 cycles</h1>"));
  EXPECT_THAT(page, HasSubstr("<li>sigma [N/m]: at cycle 61 a step</li>"));
  EXPECT_THAT(page, HasSubstr("<figure id=\"evolution-1\">"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">alpha_open</th><td class=\"number\">7</td>"));
  EXPECT_THAT(page, HasSubstr("250 mJ dissipated"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

TEST(BatchIndex, LinksPagesReportsFaultsAndShowsOnlyIdentifiableParameters) {
  identification::ParameterEstimate sigma;
  sigma.name = "sigma";
  sigma.unit = "N/m";
  sigma.value = 4e7;
  sigma.standard_error = 4e5;
  sigma.lower95 = 3.92e7;
  sigma.upper95 = 4.08e7;
  sigma.status = identification::ParameterStatus::kFree;
  sigma.identifiability = identification::Identifiability::kIdentifiable;
  identification::ParameterEstimate open = sigma;
  open.value = 7.777e7;
  open.identifiability = identification::Identifiability::kNotIdentifiable;
  const std::vector<FileResult> files = {
      {.file = "a <b>.csv",
       .page = "a <b>.html",
       .verdict = "adequate",
       .fault = "",
       .parameters = {sigma}},
      {.file = "c.csv", .page = "c.html", .verdict = "doubtful", .fault = "", .parameters = {open}},
      {.file = "d.csv",
       .page = "",
       .verdict = "",
       .fault = "d.csv:2:1: no number",
       .parameters = {}}};
  const std::vector<RepeatedQuantity> repeated = {{.name = "sigma",
                                                   .unit = "N/m",
                                                   .repeats = {.count = 2,
                                                               .mean = 4e7,
                                                               .standard_deviation = 3e6,
                                                               .stated_error = 4e5,
                                                               .p_value = 1e-5}}};
  const std::string page = BatchIndexPage(files, repeated);
  EXPECT_THAT(page, HasSubstr("<h1>2 of 3 files fitted</h1>"));
  EXPECT_THAT(page, HasSubstr("<a href=\"a%20%3Cb%3E.html\">a &lt;b&gt;.csv</a>"));
  EXPECT_THAT(page, HasSubstr("40.00 ± 0.40 N/µm"));
  EXPECT_THAT(page, Not(HasSubstr("77.77")));
  EXPECT_THAT(page, HasSubstr("d.csv:2:1: no number"));
  EXPECT_THAT(page, HasSubstr("more than the errors"));
  EXPECT_THAT(page, Not(HasSubstr("figure id")));  // of one file there is nothing to compare
}

}  // namespace
}  // namespace mindahl::campaign::pages_test
