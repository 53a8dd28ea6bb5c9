#include "mindahl/request/batch.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "mindahl/core/version.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::request::batch_test {
namespace {

std::vector<io::RecordFile> CleanRecord() {
  io::RecordFile file;
  file.record.displacement = testing::Sine(3, 100);
  for (double& displacement : file.record.displacement) displacement *= 3e-6;
  file.record.force = testing::Respond(testing::Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0},
                                       file.record.displacement);
  return {file};
}

TEST(FitSource, IsNotDoneWhereItsPageCannotBeWritten) {
  const auto fit = [] { return FitRecords({}, CleanRecord()); };
  EXPECT_TRUE(FitSource("loop", Strictness::kNone, fit).done());
  const BatchEntry entry = FitSource(
      "loop", Strictness::kNone, []() -> report::Report { throw InputError("the disk is full"); });
  EXPECT_FALSE(entry.done());
  EXPECT_EQ(entry.fault, "the disk is full");
}

TEST(FitSource, StatesTheErrorOfAWidenedIntervalAndNoneAtABound) {
  std::vector<io::RecordFile> bent = CleanRecord();  // by a spring that hardens
  for (std::size_t k = 0; k < bent[0].record.force.size(); ++k) {
    bent[0].record.force[k] += 1.5 * std::pow(bent[0].record.displacement[k] / 3e-6, 3);
  }
  report::Report report;
  const BatchEntry entry = FitSource("loop", Strictness::kNone, [&] {
    return report = FitRecords({.fit = {.bounds = {{"alpha", {0.5, 2.0}}}}}, bent);
  });
  const auto& sigma = *report.fit.Find("sigma");
  ASSERT_TRUE(sigma.includes_discrepancy);
  EXPECT_GT(entry.errors.at("sigma"), 2 * sigma.standard_error.value_or(0.0));
  EXPECT_EQ(entry.errors.at("sigma"), report.fit.ErrorOf(sigma));
  EXPECT_FALSE(entry.errors.contains("alpha"));
}

TEST(FitFiles, GoesOnAfterAFileThatCannotBeRead) {
  const FitRequest request{.files = {"none_1.csv", "none_2.csv", "none_3.csv", "none_4.csv"}};
  const std::vector<BatchEntry> entries = FitFiles(request, Strictness::kNone, 2);
  ASSERT_EQ(entries.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(entries[k].file, request.files[k]);
    EXPECT_THAT(entries[k].fault, HasSubstr(request.files[k]));
  }
}

/// A fit of which only Tc and the half gap are known.
struct Made {
  double slip_force = 0.0;
  double error = 0.0;
  std::string verdict = "identifiable";
  double half_gap = 0.0;
  bool done = true;
  double r_squared = 1.0;
  std::vector<std::string> warnings = {};
};

BatchEntry EntryOf(const Made& made, const std::string& file) {
  nlohmann::ordered_json json;
  json["parameters"]["slip_force"] = {{"value", made.slip_force},
                                      {"identifiability", made.verdict}};
  json["measured"]["half_gap"]["value"] = made.half_gap;
  json["residuals"]["r_squared"] = made.r_squared;
  for (const std::string& code : made.warnings) json["warnings"].push_back({{"code", code}});
  BatchEntry entry;
  if (!made.done) entry.fault = "not done";
  entry.file = file;
  entry.fit = json.dump();
  const bool is_known = made.verdict == "identifiable" || made.verdict == "effective";
  if (is_known && made.error > 0) entry.errors["slip_force"] = made.error;
  return entry;
}

std::vector<BatchEntry> EntriesOf(const std::vector<Made>& made) {
  std::vector<BatchEntry> entries;
  for (const Made& one : made) {
    entries.push_back(EntryOf(one, std::string(1, static_cast<char>('a' + entries.size()))));
  }
  return entries;
}

nlohmann::json RepeatsOf(const std::vector<Made>& made) {
  return nlohmann::json::parse(AnswerOf(EntriesOf(made)).json)["repeats"];
}

constexpr double kRounding = 1e-12;

TEST(Repeats, AreOfFilesThatAreDoneAndKnowTheQuantity) {
  const std::vector<std::string> kInadequate = {"model_inadequate"};
  const auto repeats = RepeatsOf({{40, 3, "identifiable", 41},
                                  {48, 1, "effective", 43},
                                  {1000, 1, "bounded_below", 48},
                                  {2000, 1, "identifiable", 99, /*done=*/false},
                                  // no loop is seen
                                  {9, 1, "not_identifiable", 1, true, 0.05, kInadequate},
                                  // small beside readings that a loss weighs down
                                  {44, 2, "identifiable", 44, true, 0.05}});
  const auto& slip_force = repeats["slip_force"];
  EXPECT_EQ(slip_force["files"], 3);
  EXPECT_NEAR(slip_force["mean"], 44.0, kRounding);
  EXPECT_NEAR(slip_force["standard_deviation"], std::sqrt(32.0 / 2), 10 * kRounding);
  EXPECT_NEAR(slip_force["stated_error"], std::sqrt((9.0 + 1.0 + 4.0) / 3), 10 * kRounding);
  // Measured without a model: no error is stated, and the verdict on Tc is none on the gap.
  const auto& half_gap = repeats["half_gap"];
  EXPECT_EQ(half_gap["files"], 4);
  EXPECT_NEAR(half_gap["mean"], 44.0, kRounding);
  EXPECT_NEAR(half_gap["standard_deviation"], std::sqrt((9.0 + 1 + 16) / 3), 10 * kRounding);
  EXPECT_TRUE(half_gap["stated_error"].is_null());
  EXPECT_FALSE(repeats.contains("sigma"));
}

TEST(Repeats, CompareNoParametersOfSeveralLaws) {
  std::vector<BatchEntry> entries = EntriesOf(
      {{40, 1, "identifiable", 39}, {50, 1, "identifiable", 39}, {42, 1, "identifiable", 39}});
  const auto set_law = [&](std::size_t k, const char* law) {
    auto json = nlohmann::ordered_json::parse(entries[k].fit);
    json["model"] = law;
    entries[k].fit = json.dump();
  };
  for (const std::size_t k : {0U, 1U, 2U}) set_law(k, "mindlin-dahl");
  EXPECT_THAT(AnswerOf(entries).text, Not(HasSubstr("several laws")));
  set_law(1, "dahl");
  const auto repeats = nlohmann::json::parse(AnswerOf(entries).json)["repeats"];
  EXPECT_FALSE(repeats.contains("slip_force"));
  EXPECT_EQ(repeats["half_gap"]["files"], 3);
  EXPECT_THAT(AnswerOf(entries).text, HasSubstr("fits are by several laws"));
  EXPECT_THAT(AnswerOf(entries).index, HasSubstr("fits are by several laws"));
}

TEST(BatchIndex, LinksPagesAndReportsParametersAndFaults) {
  std::vector<BatchEntry> entries = EntriesOf({{40, 1}, {70, 1}});
  entries.emplace_back().file = "d.csv";
  entries[0].file = "a <b>.csv";
  entries[0].verdict = "adequate";
  entries[0].parameters = {"40.00 N/µm (39.20 … 40.80)", "not determined", "> 4 N"};
  entries[1].verdict = "doubtful";
  entries[2].fault = "d.csv:2:1: no number";
  const std::string page = AnswerOf(entries).index;
  EXPECT_THAT(page, HasSubstr("<h1>2 of 3 files fitted</h1>"));
  EXPECT_THAT(page, HasSubstr("<a href=\"page-1.html\">a &lt;b&gt;.csv</a>"));
  EXPECT_THAT(page, HasSubstr("<a href=\"page-2.html\">"));
  EXPECT_THAT(page, HasSubstr("40.00 N/µm (39.20 … 40.80)"));
  EXPECT_THAT(page, HasSubstr("not determined"));
  EXPECT_THAT(page, HasSubstr("d.csv:2:1: no number"));
  EXPECT_THAT(page, HasSubstr("stated_error"));
  EXPECT_THAT(page, Not(HasSubstr("figure id")));  // of one file there is nothing to compare
}

/// A fit whose JSON has a number of its own at every place that a column is read from.
BatchEntry EntryOfAllColumns() {
  BatchEntry entry;
  entry.file = "a,b.csv";
  entry.fit = R"({
    "input": {"samples": 301, "cycles": 3}, "model": "dahl", "initial_state": "steady",
    "adequacy": {"verdict": "doubtful"},
    "measured": {"half_gap": {"value": 3.5}, "amplitude": 1.5, "peak_force": 2.5,
                 "energy_per_cycle": 5.5, "energy_ratio": 6.5, "slides": true},
    "parameters": {
      "sigma": {"value": 7.5, "standard_error": 8.5, "ci95": [9.5, 10.5], "identifiability": "v1"},
      "alpha": {"value": 11.5, "standard_error": 12.5, "ci95": [13.5, null],
                "identifiability": "v2"},
      "slip_force": {"value": 14.5, "standard_error": null, "ci95": [15.5, 16.5],
                     "identifiability": "v3"}},
    "residuals": {"rms": 17.5, "r_squared": 18.5},
    "contact": {"normal_load": {"value": 19.5}, "friction_coefficient": {"value": 20.5,
                "ci95": [21.5, 21.75]}, "contact_radius": {"value": 22.5}},
    "warnings": [{"code": "one"}, {"code": "two"}]})";
  return entry;
}

TEST(BatchTable, HasEachNumberInItsColumn) {
  const std::vector<BatchEntry> entries = {EntryOfAllColumns()};
  const std::string csv = AnswerOf(entries).table;
  EXPECT_EQ(csv,
            "file,done,samples,model,initial_state,adequacy,cycles,amplitude,peak_force,half_gap,"
            "energy_per_cycle,energy_ratio,sigma,sigma_error,sigma_lower95,"
            "sigma_upper95,sigma_verdict,alpha,alpha_error,alpha_lower95,alpha_upper95,"
            "alpha_verdict,slip_force,slip_force_error,slip_force_lower95,slip_force_upper95,"
            "slip_force_verdict,rms,r_squared,slides,normal_load,friction_coefficient,"
            "friction_coefficient_lower95,friction_coefficient_upper95,contact_radius,warnings,"
            "fault,version\n"
            "\"a,b.csv\",yes,301,dahl,steady,doubtful,3,1.5,2.5,3.5,5.5,6.5,7.5,8.5,9.5,10.5,"
            "v1,11.5,12.5,13.5,,v2,14.5,,15.5,16.5,v3,17.5,18.5,yes,19.5,20.5,21.5,21.75,22.5,one "
            "two,," +
                std::string(Version()) + "\n");
}

TEST(BatchTable, HasNoValueThatIsNotKnown) {
  const auto made = EntriesOf({{1234, 1, "bounded_below", 48}});
  EXPECT_THAT(AnswerOf(made).table, Not(HasSubstr("1234,")));
  EXPECT_THAT(AnswerOf(made).table, HasSubstr("bounded_below"));
}

TEST(BatchJson, HasEveryFileWithItsFitOrItsFault) {
  std::vector<BatchEntry> entries = {EntryOfAllColumns(), {}};
  entries[1].file = "c";
  entries[1].fault = "no loop";
  auto json = nlohmann::json::parse(AnswerOf(entries, "t.csv").json);
  EXPECT_EQ(json["schema"], "mindahl.batch/1");
  EXPECT_EQ(json["output"], "t.csv");
  EXPECT_EQ(json["files"][0]["file"], "a,b.csv");
  EXPECT_TRUE(json["files"][0]["done"]);
  EXPECT_TRUE(json["files"][0]["fault"].is_null());
  EXPECT_EQ(json["files"][0]["fit"], nlohmann::json::parse(entries[0].fit));
  EXPECT_FALSE(json["files"][1]["done"]);
  EXPECT_EQ(json["files"][1]["fault"], "no loop");
  EXPECT_TRUE(json["files"][1]["fit"].is_null());
  EXPECT_TRUE(json["repeats"].empty());
  EXPECT_TRUE(nlohmann::json::parse(AnswerOf(entries).json)["output"].is_null());
}

}  // namespace
}  // namespace mindahl::request::batch_test
