
#include <nlohmann/json.hpp>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

// Of which memory a record is, in the JSON and in the text.
namespace mindahl::report::memory_test {
namespace {

using identification::MemoryTest;
using identification::MemoryVerdict;
using nlohmann::json;

MemoryTest Neither() {
  return {.verdict = MemoryVerdict::kNeither,
          .p_value = 0.0025,
          .dahl_p_value = 1e-9,
          .comparisons = {{"directions", 0.0005, 0.25, 0.125}, {"amplitudes", 0.5, 0.75, 0.0}}};
}

Report ReportOf(const MemoryTest& memory) {
  ReportInput input = MadeInput();
  input.fit.memory = memory;
  return MakeReport(std::move(input));
}

TEST(Memory, HasItsComparisonsInTheJson) {
  const json memory = json::parse(ToJson(ReportOf(Neither())))["memory"];
  EXPECT_EQ(memory["verdict"], "neither");
  EXPECT_EQ(memory["p_value"], 0.0025);
  EXPECT_EQ(memory["dahl_p_value"], 1e-9);
  ASSERT_EQ(memory["tests"].size(), 2U);
  EXPECT_EQ(
      memory["tests"][0],
      json({{"code", "directions"}, {"p_value", 0.0005}, {"dahl_p_value", 0.25}, {"size", 0.125}}));
}

TEST(Memory, OfNeitherLawSaysWhereBranchesDifferAndByHowMuch) {
  EXPECT_THAT(ToText(ReportOf(Neither())),
              AllOf(HasSubstr("memory: neither Masing's (p = 0.0025) nor Dahl's (p < 1e-6)"),
                    HasSubstr("up and down strokes differ by 125 mN")));
}

TEST(Memory, ThatIsUndecidedSaysWhatWouldDecide) {
  MemoryTest memory = Neither();
  memory.verdict = MemoryVerdict::kUndecided;
  EXPECT_THAT(ToText(ReportOf(memory)),
              AllOf(HasSubstr("Masing's (p = 0.0025) or Dahl's (p < 1e-6), undecided"),
                    HasSubstr("further")));
  memory.comparisons.pop_back();
  EXPECT_THAT(ToText(ReportOf(memory)), AllOf(HasSubstr("second"), Not(HasSubstr("further"))));
}

TEST(Memory, ThatIsDecidedNamesTheLawItIsOf) {
  MemoryTest memory = Neither();
  memory.verdict = MemoryVerdict::kMasing;
  EXPECT_THAT(ToText(ReportOf(memory)), HasSubstr("memory: Masing's (p = 0.0025), not Dahl's"));
  memory.verdict = MemoryVerdict::kDahl;
  EXPECT_THAT(ToText(ReportOf(memory)), HasSubstr("memory: Dahl's (p < 1e-6), not Masing's"));
}

TEST(Memory, HasEveryComparisonInTheText) {
  for (const std::string_view code : identification::MemoryComparisonCodes()) {
    MemoryTest memory = Neither();
    memory.comparisons = {{code, 0.0005, 0.25, 0.125}};
    EXPECT_THAT(ToText(ReportOf(memory)), HasSubstr("0.0005")) << code;
  }
}

TEST(Memory, ThatWasNotAskedForIsNullWithAReason) {
  const json report = json::parse(ToJson(MakeReport(MadeInput())));
  EXPECT_TRUE(report["memory"]["verdict"].is_null());
  EXPECT_TRUE(report["memory"]["tests"].empty());
  EXPECT_THAT(ToText(MakeReport(MadeInput())), Not(HasSubstr("memory:")));
}

TEST(MemoryOfALoop, IsNullWhereItWasNotAskedForOrCannotBeCompared) {
  for (const auto& [depth, why] :
       {std::pair(identification::Depth::kFull, "the fit was not asked for it"),
        std::pair(identification::Depth::kThorough, "branches are not compared before")}) {
    ReportInput input = MadeInput();
    input.fit.depth = depth;
    input.fit.memory.reset();
    const json fit = json::parse(ToJson(MakeReport(std::move(input))));
    const auto null = std::ranges::find(fit["nulls"], "memory.verdict",
                                        [](const json& each) { return each["path"]; });
    ASSERT_NE(null, fit["nulls"].end());
    EXPECT_THAT((*null)["why"].get<std::string>(), ::testing::StartsWith(why));
  }
}

}  // namespace
}  // namespace mindahl::report::memory_test
