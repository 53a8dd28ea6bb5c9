#include "report/json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

namespace mindahl::report::json_test {
namespace {

using testing::FailedInput;
using testing::kMadeAmplitude;
using testing::MadeInput;
using testing::MadeRecord;

Json Document(ReportInput input) { return Json::parse(ToJson(MakeReport(std::move(input)))); }

TEST(Json, OfAFitThatFailedHasNoNumberOfIt) {
  const Json document = Document(FailedInput());
  EXPECT_THAT(document["parameters"], IsEmpty());
  EXPECT_THAT(document["contact"], IsEmpty());
  EXPECT_TRUE(document["residuals"]["rms"].is_null());
  EXPECT_TRUE(document["adequacy"]["verdict"].is_null());
  EXPECT_EQ(document["warnings"][0]["code"], "not_converged");
}

TEST(Json, GivesNoValueWhereTheSearchStoppedAtItsOwnLimit) {
  ReportInput input = MadeInput();
  input.fit.parameters.push_back(testing::MadeParameter("slip_speed", "-", 1.0, 0.5));
  input.fit.parameters.back().status = identification::ParameterStatus::kAtUpperBound;
  input.fit.parameters.back().identifiability = identification::Identifiability::kNotIdentifiable;
  const Json parameter = Document(std::move(input))["parameters"]["slip_speed"];
  EXPECT_TRUE(parameter["value"].is_null());
  EXPECT_TRUE(parameter["ci95"][1].is_null());
}

TEST(Json, NamesTheColumnsThatWereRead) {
  ReportInput input = MadeInput();
  input.records[0].force = {.name = "F [kN]", .index = 3, .unit = "kN"};
  const Json columns = Document(std::move(input))["input"]["columns"];
  EXPECT_EQ(columns["force"], Json({{"name", "F [kN]"}, {"index", 3}, {"unit", "kN"}}));
  EXPECT_TRUE(columns["normal_load"].is_null());
}

TEST(Json, HasTheNextStepThatWasTried) {
  ReportInput input = MadeInput();
  EXPECT_TRUE(Document(input)["next"].is_null());
  input.next = testing::MadeStep("--terms lag");
  EXPECT_EQ(Document(input)["next"]["options"], "--terms lag");
}

TEST(Json, OfATorqueHasItsUnitsAndNoContact) {
  ReportInput input = MadeInput();
  input.records[0].is_torsional = true;
  input.fit.parameters.push_back(testing::MadeParameter("plateau_curvature", "N/m²", 1.0, 0.1));
  const Json document = Document(std::move(input));
  EXPECT_EQ(document["parameters"]["sigma"]["unit"], "N m/rad");
  EXPECT_EQ(document["parameters"]["plateau_curvature"]["unit"], "N m/rad²");
  EXPECT_THAT(document["contact"], IsEmpty());
  EXPECT_TRUE(document["mapping"]["alpha_minus_third"].is_null());
}

TEST(Json, HasNoDistanceFromAThirdOfAShapeThatIsNotKnown) {
  ReportInput input = MadeInput();
  EXPECT_FALSE(Document(input)["mapping"]["alpha_minus_third"].is_null());
  for (identification::ParameterEstimate& estimate : input.fit.parameters) {
    estimate.identifiability = identification::Identifiability::kNotIdentifiable;
  }
  EXPECT_TRUE(Document(input)["mapping"]["alpha_minus_third"].is_null());
}

TEST(Json, ListsWhatIsLeftOut) {
  ReportInput input = MadeInput();
  input.records[0].lines = {2, 3, 4, 5, 6, 7, 8, 9, 10};
  input.left_out = {{.file = "a.csv", .samples = 3, .first = 2, .last = 4, .why = "rest"}};
  const Json left_out = Document(std::move(input))["input"]["left_out"];
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_EQ(left_out[0]["first"], 2);
  EXPECT_EQ(left_out[0]["last"], 4);
  EXPECT_EQ(left_out[0]["why"], "rest");
}

TEST(Json, NamesUpToFiveRunsOfFaultsByTheirLinesAndTheOthersByTheirCause) {
  ReportInput input = MadeInput({MadeRecord(kMadeAmplitude, 15)}, kMadeAmplitude);
  input.fit.records[0].glitches = {0, 1, 3, 5, 7, 9};
  std::vector<unsigned char>& counts = input.fit.records[0].counts;
  counts.assign(input.records[0].record.size(), 1);
  for (const std::size_t i : {0, 1, 3, 5, 7, 9, 11, 12}) counts.at(i) = 0;
  const auto left_out = [&] {
    std::vector<std::string> parts;
    const Json document = Document(ReportInput(input));
    for (const Json& part : document["input"]["left_out"]) {
      parts.push_back(fmt::format("{} {}-{} {}", part["samples"].dump(), part["first"].dump(),
                                  part["last"].dump(), part["why"].dump()));
    }
    return parts;
  };
  EXPECT_THAT(left_out(), ElementsAre("2 1-2 \"faults\"", "1 4-4 \"faults\"", "1 6-6 \"faults\"",
                                      "1 8-8 \"faults\"", "1 10-10 \"faults\"", "2 12-13 \"lag\""));
  input.fit.records[0].first_stroke = 12;
  EXPECT_THAT(left_out(), Contains("1 12-12 \"unrecorded turn\""));
  input.fit.records[0].glitches.push_back(11);
  input.options.preparation.cycles = {1, 1};
  EXPECT_THAT(left_out(), ElementsAre("7 null-null \"faults\"", "1 13-13 \"selection\""));
}

TEST(MakeReport, RefusesAnotherNumberOfRecords) {
  ReportInput input = MadeInput();
  input.records.push_back(input.records.front());
  EXPECT_THROW(MakeReport(std::move(input)), InvalidArgument);
}

// ---

std::string Page(ReportInput input, std::string_view command = {}) {
  return ToPage(MakeReport(std::move(input)), command);
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
  input.records.front().name = "<b>&.csv";
  const std::string page = Page(std::move(input), "mindahl fit '<b>&.csv'");
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;&amp;.csv"));
  EXPECT_THAT(page, Not(HasSubstr("<b>&.csv")));
}

TEST(Page, HasTheCommandOfTheNextStep) {
  ReportInput input = MadeInput();
  input.next = testing::MadeStep("--terms lag");
  EXPECT_THAT(Page(std::move(input), "mindahl fit a.csv"),
              HasSubstr("mindahl fit a.csv --terms lag"));
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
}  // namespace mindahl::report::json_test
