
#include <nlohmann/json.hpp>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

// The JSON from the library's side. tests/cli walks that of many runs of the program.
namespace mindahl::report::json_test {
namespace {

using namespace contact;

using nlohmann::json;
using report::MakeReport;
using report::ToJson;

json Parsed(report::ReportInput input) { return json::parse(ToJson(MakeReport(std::move(input)))); }

TEST(Json, HasTheNumbersOfTheFit) {
  const json fit = Parsed(MadeInput());
  EXPECT_EQ(fit["parameters"]["sigma"]["value"], testing::kSigma);
  EXPECT_EQ(fit["parameters"]["sigma"]["standard_error"], 0.01 * testing::kSigma);
  EXPECT_EQ(fit["parameters"]["sigma"]["ci95"][1], 1.02 * testing::kSigma);
  EXPECT_EQ(fit["input"]["files"][0], "loop_1.csv");
  EXPECT_EQ(fit["input"]["samples"], 9);
  EXPECT_EQ(fit["loop"]["amplitude"], testing::kMadeAmplitude);
}

TEST(InitialState, OfRecordsThatDifferIsMixedAndInTheTextThatOfEach) {
  const loop::Record record = testing::MadeRecord(1e-6);
  report::ReportInput input = testing::MadeInput({record, record}, 1e-6);
  input.fit.initial_state = input.fit.records[0].initial_state = models::InitialState::kSteady;
  input.fit.records[1].initial_state = models::InitialState::kVirgin;
  const report::Report report = MakeReport(std::move(input));
  EXPECT_EQ(json::parse(ToJson(report))["initial_state"], "mixed");
  EXPECT_THAT(ToText(report), HasSubstr("steady, virgin initial state"));
}

TEST(Json, NamesTheParameterForWhichThereIsNoCorrelation) {
  report::ReportInput input = MadeInput();
  const double none = std::numeric_limits<double>::quiet_NaN();
  input.fit.correlation = {1, none, 0, none, none, none, 0, none, 1};  // alpha is at its bound
  const json nulls = Parsed(std::move(input))["nulls"];
  for (const char* path : {"correlation.sigma.alpha", "correlation.alpha.sigma"}) {
    const json expected = {{"path", path}, {"why", "alpha is at a bound or undetermined"}};
    EXPECT_THAT(nulls, ::testing::Contains(expected));
  }
}

TEST(Json, HasEachPartThatIsTrimmed) {
  report::ReportInput input = MadeInput();
  input.trims = {{.samples = 9,
                  .parts = {{.reason = loop::TrimReason::kRunningIn,
                             .first = 1,
                             .last = 5,
                             .cycles = 2,
                             .at_start = true,
                             .has_first_loading = true}}}};
  const json trimmed = Parsed(std::move(input))["input"]["trimmed"];
  ASSERT_EQ(trimmed.size(), 1U);
  EXPECT_EQ(trimmed[0], json({{"file", "loop_1.csv"},
                              {"reason", "running_in"},
                              {"first_line", 2},
                              {"last_line", 5},
                              {"samples", 4},
                              {"cycles", 2},
                              {"first_loading", true}}));
}

TEST(Json, HasTheTestsOfTheMapping) {
  report::ReportInput input = MadeInput();
  input.fit.parameters[1] = testing::MadeParameter("alpha", "-", 0.35, 0.01);
  const report::Report report = MakeReport(std::move(input));
  const json mapping = json::parse(ToJson(report))["mapping"];
  ASSERT_TRUE(report.alpha.z && report.alpha.p_value && report.alpha.minus_third);
  EXPECT_EQ(mapping["alpha_minus_third"], 0.35 - 1.0 / 3);
  EXPECT_EQ(mapping["z"], *report.alpha.z);
  EXPECT_GT(*report.alpha.z, 1.0) << "of an error of a hundredth or so";
  EXPECT_EQ(mapping["p_value"], *report.alpha.p_value);
}

TEST(Json, OfAnOpenIntervalNamesItsEnd) {
  report::ReportInput input = MadeInput();
  input.fit.parameters[2].upper95.reset();
  const json fit = Parsed(std::move(input));
  EXPECT_TRUE(fit["parameters"]["slip_force"]["ci95"][1].is_null());
  const json expected = {{"path", "parameters.slip_force.ci95[1]"},
                         {"why", "the record sets no limit there"}};
  EXPECT_THAT(fit["nulls"], ::testing::Contains(expected));
}

TEST(Json, OfAFitThatFailedIsNullForThatReason) {
  const json fit = Parsed(FailedInput());
  ASSERT_EQ(fit["warnings"].size(), 1u);
  EXPECT_EQ(fit["warnings"][0]["code"], "fit_failed");
  std::size_t of_the_fit = 0;
  std::size_t of_the_record = 0;
  for (const json& null : fit["nulls"]) {
    const bool is_measured = null["path"].get<std::string>().starts_with("measured.");
    of_the_record += is_measured && null["why"] == "the record closes no cycle" ? 1 : 0;
    of_the_fit += null["why"] == "the fit failed: no start led anywhere" ? 1 : 0;
  }
  // All but the normal load, which was not given, and what needs no fit.
  EXPECT_GT(of_the_record, 0u);
  EXPECT_EQ(of_the_fit + of_the_record + 1, fit["nulls"].size());
}

TEST(Json, EndsWithAnEndOfLine) { EXPECT_EQ(ToJson(MakeReport(MadeInput())).back(), '\n'); }

TEST(Json, ListsFirstFindingFirst) {
  report::ReportInput input = MadeInput();
  input.fit.findings.push_back(
      {.code = "shape_or_rig", .numbers = {{"rig_stiffness", 1e6}, {"alpha", 0.1}}});
  input.known.contact_radius = 2e-4;
  input.known.normal_load = 50.0;
  for (KnownBody* body : {&input.known.body_1, &input.known.body_2}) {
    *body = {.youngs_modulus = 2e11, .poisson_ratio = 0.3, .radius = 0.1};
  }
  const json warnings = Parsed(std::move(input))["warnings"];
  ASSERT_GE(warnings.size(), 2u);
  EXPECT_EQ(warnings[0]["code"], "shape_or_rig");
  EXPECT_EQ(warnings[1]["code"], "contact_redundant");
}

TEST(Json, HasNotesApartFromWhatToActOn) {
  report::ReportInput input = MadeInput();
  input.fit.findings = {{.code = "no_closed_cycle", .severity = identification::Severity::kNote},
                        {.code = "weights_not_settled"}};
  const json fit = Parsed(std::move(input));
  ASSERT_EQ(fit["notes"].size(), 1u);
  EXPECT_EQ(fit["notes"][0]["code"], "no_closed_cycle");
  ASSERT_EQ(fit["warnings"].size(), 1u);
  EXPECT_EQ(fit["warnings"][0]["code"], "weights_not_settled");
}

TEST(Json, HasTheGateOfTheWidestRecordAndTheOtherWhereItIsNotCertain) {
  report::ReportInput input = MadeInput();
  input.fit.records[0].gate = {.gate = 1e-7, .count = 1};
  json fit = Parsed(input);
  EXPECT_EQ(fit["reversals"], json({{"count", 1}, {"gate", 1e-7}, {"certain", true}}));
  input.fit.records[0].gate = {1e-7, 1, false, 40, 1e-9};
  input.fit.records[0].glitches = {.spikes = 2, .dropouts = 1, .held = 5};
  fit = Parsed(input);
  EXPECT_EQ(fit["reversals"]["other_count"], 40);
  EXPECT_EQ(fit["reversals"]["other_gate"], 1e-9);
  EXPECT_EQ(fit["input"]["glitches"], json({{"spikes", 2}, {"dropouts", 1}, {"held", 5}}));
}

TEST(MakeReport, RefusesWhatDoesNotBelongTogether) {
  report::ReportInput unnamed = MadeInput();
  unnamed.files.clear();
  EXPECT_THROW(MakeReport(std::move(unnamed)), InvalidArgument);
  report::ReportInput without_record = MadeInput();
  without_record.records.clear();
  EXPECT_THROW(MakeReport(std::move(without_record)), InvalidArgument);
  report::ReportInput other_record = MadeInput();
  other_record.records[0].record = testing::MadeRecord(1e-6, 5);
  EXPECT_THROW(MakeReport(std::move(other_record)), InvalidArgument);
  report::ReportInput unloaded = MadeInput();
  unloaded.load_window = {1, 2};
  EXPECT_THROW(MakeReport(std::move(unloaded)), InvalidArgument);
  EXPECT_THROW(MakeReport({}), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::report::json_test
