#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

namespace mindahl::report::page_test {
namespace {

using testing::MadeInput;
using testing::MadeRecord;

std::string Page(ReportInput input, const Provenance& provenance = {}) {
  return ToPage(MakeReport(std::move(input)), provenance);
}

TEST(Page, HasTheAnswerTheLoopAndItsResidual) {
  const std::string page = Page(MadeInput());
  EXPECT_THAT(page, StartsWith("<!DOCTYPE html>"));
  for (const char* part : {"id=\"loop\"", "id=\"residual\"", "id=\"intervals\"", "1/3",
                           "Tc 40.00 N (39.20 … 40.80)"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

TEST(Page, IsGreenOnlyOfWhatMayBeQuoted) {
  ReportInput input = MadeInput();
  EXPECT_THAT(Page(input), HasSubstr("interval good"));
  input.fit.adequacy.verdict = identification::AdequacyVerdict::kDoubtful;
  for (auto& estimate : input.fit.parameters) {
    estimate.identifiability = identification::Identifiability::kEffective;
  }
  EXPECT_THAT(Page(input), Not(HasSubstr("interval good")));
  EXPECT_THAT(Page(input), HasSubstr("interval poor"));
  for (auto& estimate : input.fit.parameters) {
    estimate.identifiability = identification::Identifiability::kNotIdentifiable;
  }
  EXPECT_THAT(Page(input), Not(HasSubstr("id=\"intervals\"")));
}

TEST(Page, OfAFitThatFailedSaysWhy) {
  const std::string page = Page(testing::FailedInput());
  EXPECT_THAT(page, HasSubstr("no start led anywhere"));
  EXPECT_THAT(page, Not(HasSubstr("<figure")));
}

TEST(Page, EscapesWhatItIsGiven) {
  ReportInput input = MadeInput();
  input.files = {"<b>&.csv"};
  const std::string page = Page(std::move(input), {"mindahl fit '<b>&.csv'", {}, {}});
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;&amp;.csv"));
  EXPECT_THAT(page, Not(HasSubstr("<b>&.csv")));
}

TEST(Page, HasTheCommandOfTheNextStep) {
  ReportInput input = MadeInput();
  input.next = testing::MadeStep("--terms lag");
  EXPECT_THAT(Page(std::move(input), {"mindahl fit a.csv", {}, {}}),
              HasSubstr("mindahl fit a.csv <span class=\"option\">--terms</span> lag"));
}

TEST(ToPlot, PutsTheResidualOverTheSameAxis) {
  const io::Plot plot = ToPlot(MakeReport(MadeInput()));
  ASSERT_EQ(plot.panels[0].series.size(), 2U);
  EXPECT_EQ(plot.panels[0].series[0].x, plot.panels[1].series[0].x);
  EXPECT_NEAR(plot.panels[0].series[0].x[0], 2.0, 1e-12);  // µm
  EXPECT_NEAR(plot.panels[1].series[0].y[8], 1.0, 1e-12);
}

TEST(ToPlot, CallsRecordsOfASeriesByTheirLoads) {
  ReportInput input = testing::MadeInput({MadeRecord(2e-6), MadeRecord(2e-6)}, 2e-6);
  EXPECT_EQ(ToPlot(MakeReport(input)).panels[0].series[1].label, "loop_2.csv");
  testing::AddParameter(input.fit, "load_exponent", "-", 0.33, 0.01);
  input.fit.normal_load = 30.0;
  input.fit.records[0].normal_load = 20.0;
  input.fit.records[1].normal_load = 40.0;
  const io::Plot plot = ToPlot(MakeReport(input));
  EXPECT_EQ(plot.panels[0].series[0].label, "20 N");
  EXPECT_EQ(plot.panels[0].series[1].label, "40 N");
}

TEST(ToPlot, ShowsTheFitOfTheNextStep) {
  ReportInput input = MadeInput();
  input.next = testing::MadeStep("--terms lag");
  input.next->fitted_force = {input.fit.records[0].fitted_force};
  const io::Plot plot = ToPlot(MakeReport(std::move(input)));
  EXPECT_EQ(plot.panels[0].series.back().label, "fitted with --terms lag");
}

}  // namespace
}  // namespace mindahl::report::page_test
