#include "report/json.h"

#include <nlohmann/json.hpp>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

namespace mindahl::report::json_test {
namespace {

using testing::FailedInput;
using testing::MadeInput;

Json Document(ReportInput input) { return Json::parse(ToJson(MakeReport(std::move(input)))); }

TEST(Json, OfAFitThatFailedHasNoNumberOfIt) {
  const Json document = Document(FailedInput());
  EXPECT_THAT(document["parameters"], IsEmpty());
  EXPECT_THAT(document["contact"], IsEmpty());
  EXPECT_TRUE(document["residuals"]["rms"].is_null());
  EXPECT_TRUE(document["adequacy"]["verdict"].is_null());
  EXPECT_EQ(document["warnings"][0]["code"], "fit_failed");
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

TEST(MakeReport, DeterminesNothingFromNoMoreSamplesThanParameters) {
  ReportInput input = MadeInput();
  input.fit.residuals.samples = 3;
  const Json document = Document(std::move(input));
  EXPECT_TRUE(document["adequacy"]["verdict"].is_null());
  EXPECT_EQ(document["parameters"]["sigma"]["identifiability"], "not_identifiable");
  EXPECT_TRUE(document["parameters"]["sigma"]["ci95"][0].is_null());
}

TEST(MakeReport, RefusesAnotherNumberOfNames) {
  ReportInput input = MadeInput();
  input.files.emplace_back("one more");
  EXPECT_THROW(MakeReport(std::move(input)), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::report::json_test
