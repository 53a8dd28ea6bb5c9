
#include <nlohmann/json.hpp>
#include <regex>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

// What needs no model, in the JSON and at the head of the text.
namespace mindahl::report::measured_test {
namespace {

using nlohmann::json;

/// Each fact unlike the others.
ReportInput MeasuredInput() {
  ReportInput input = MadeInput();
  loop::LoopFacts& facts = input.fit.records[0].facts;
  facts.closed = true;
  facts.cycles = {{.start = 3,
                   .amplitude = 2e-6,
                   .peak_force = 11,
                   .energy = 5e-5,
                   .energy_ratio = 0.5,
                   .steady = true,
                   .half_gap = 9,
                   .sliding_amplitude = 1e-6}};
  facts.steady_cycles = 1;
  facts.amplitude = 1.9e-6;
  facts.peak_force = 11.5;
  facts.energy_per_cycle = 5.5e-5;
  facts.energy_ratio = 0.625;
  facts.sliding_amplitude = 1.25e-6;
  facts.half_gap = 8.5;
  facts.half_gap_standard_deviation = 0.25;
  facts.slope_after_reversal = 3e7;
  facts.plateau_slope = 1e5;
  facts.asymmetry = 0.04;
  facts.path_ratio = 1.125;
  facts.half_gap_trend = {.slope = 0.5, .standard_error = 0.05, .p_value = 0.002};
  facts.energy_trend = {.slope = 1e-8, .standard_error = 1e-9, .p_value = 0.001};
  return input;
}

json Parsed(ReportInput input) { return json::parse(ToJson(MakeReport(std::move(input)))); }

TEST(Measured, IsInTheJson) {
  const json measured = Parsed(MeasuredInput())["measured"];
  EXPECT_EQ(measured["half_gap"], json({{"value", 8.5}, {"standard_deviation", 0.25}}));
  EXPECT_EQ(measured["sliding_amplitude"], 1.25e-6);
  EXPECT_EQ(measured["slope_after_reversal"], 3e7);
  EXPECT_EQ(measured["plateau_slope"], 1e5);
  EXPECT_EQ(measured["asymmetry"], 0.04);
  EXPECT_EQ(measured["energy_per_cycle"], 5.5e-5);
  EXPECT_EQ(measured["energy_ratio"], 0.625);
  EXPECT_EQ(measured["path_ratio"], 1.125);
  EXPECT_EQ(measured["closed"], true);
  EXPECT_EQ(measured["cycles"], json::array({{{"start", 3},
                                              {"amplitude", 2e-6},
                                              {"peak_force", 11.0},
                                              {"half_gap", 9.0},
                                              {"energy", 5e-5},
                                              {"energy_ratio", 0.5},
                                              {"sliding_amplitude", 1e-6}}}));
  EXPECT_EQ(measured["trend"]["half_gap"],
            json({{"slope", 0.5}, {"standard_error", 0.05}, {"p_value", 0.002}}));
  EXPECT_EQ(measured["trend"]["energy"]["slope"], 1e-8);
}

TEST(Measured, NullsNameMissingInputs) {
  ReportInput input = MeasuredInput();
  input.fit.records[0].facts.half_gap_trend.reset();
  input.fit.records[0].facts.half_gap_standard_deviation.reset();
  const json fit = Parsed(std::move(input));
  const auto null = [](const char* path, const char* why) {
    return json{{"path", path}, {"why", why}};
  };
  EXPECT_THAT(
      fit["nulls"],
      AllOf(Contains(null("measured.trend.half_gap.slope", "needs three steady cycles")),
            Contains(null("measured.half_gap.standard_deviation", "needs two steady cycles")),
            Contains(null("measured.energy_friction_coefficient",
                          "needs a column of the normal load, and a sliding amplitude"))));
  const json open = Parsed(MadeInput());
  EXPECT_EQ(open["measured"]["closed"], false);
  EXPECT_EQ(open["measured"]["cycles"], json::array());
  EXPECT_THAT(open["nulls"],
              Contains(null("measured.energy_per_cycle", "the record closes no cycle")));
}

TEST(Measured, AgreesWithTheLoop) {
  const json fit = Parsed(MeasuredInput());
  EXPECT_EQ(fit["loop"]["energy_per_cycle_measured"], fit["measured"]["energy_per_cycle"]);
  EXPECT_EQ(fit["loop"]["amplitude"], 1.9e-6);
  EXPECT_EQ(fit["loop"]["peak_force"], 11.5);
  EXPECT_DOUBLE_EQ(fit["loop"]["energy_ratio"], 5.5e-5 / (4 * 1.9e-6 * 11.5));
}

std::size_t Times(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  return static_cast<std::size_t>(
      std::distance(std::sregex_iterator(text.begin(), text.end(), regex), {}));
}

TEST(Measured, StandsInTheTextOnce) {
  const std::string text = ToText(MakeReport(MeasuredInput()));
  EXPECT_THAT(text, HasSubstr("measured: X = 1.9 µm, T* = 11.5 N"));
  EXPECT_THAT(text, HasSubstr("half gap 8.50 ± 0.25 N between cycles"));
  EXPECT_EQ(Times(text, "T\\* = "), 1u);
  EXPECT_EQ(Times(text, "X = "), 1u);
  EXPECT_EQ(Times(text, "energy ratio 0"), 1u);
}

TEST(Measured, NamesOnlyTrendsThatMatter) {
  // 0.5 N of 8.5 N a cycle; 1e-8 J of 5.5e-5 J.
  const std::string text = ToText(MakeReport(MeasuredInput()));
  EXPECT_THAT(std::regex_replace(text, std::regex("\\s+"), " "),
              HasSubstr("half gap changes by +5.9 ± 0.6 % a cycle (p = 0.002)"));
  EXPECT_THAT(text, Not(HasSubstr("energy changes")));
}

TEST(Measured, ReportsThatNoCycleCloses) {
  EXPECT_THAT(ToText(MakeReport(MadeInput())),
              HasSubstr("measured: X = 2 µm, T* = 10 N, no closed cycle\n"));
}

TEST(Notes, StandAtTheEndOfTheText) {
  ReportInput input = MadeInput();
  input.fit.findings = {{.code = "no_closed_cycle", .severity = identification::Severity::kNote}};
  const std::string text = ToText(MakeReport(std::move(input)));
  EXPECT_GT(text.find("\nnote: no cycle is closed"), text.find("is it Mindlin's contact?"));
  EXPECT_EQ(text.back(), '\n');
}

}  // namespace
}  // namespace mindahl::report::measured_test
