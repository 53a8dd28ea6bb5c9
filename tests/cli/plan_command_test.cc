
#include <filesystem>
#include <fstream>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

namespace mindahl::cli::plan_command_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

Outcome RunPlan(const Words& more) {
  Words words = {"plan", "--sigma", "4e7", "--slip-force", "40"};
  words.insert(words.end(), more.begin(), more.end());
  return RunCommand(words);
}

TEST(PlanCommand, ReportsAmplitudeThatReachesWantedPrecision) {
  const Outcome outcome =
      RunPlan({"--force-noise", "0.4", "--want", "alpha=0.01,slip_force=1%", "--json", "-"});
  ASSERT_EQ(outcome.status, kDone) << outcome.err;
  const json plan = outcome.Json();
  EXPECT_EQ(plan["schema"], "mindahl.plan/1");
  constexpr double kSlip = 1.5e-6;
  for (const json& reached : plan["reached"]) {
    EXPECT_GT(reached["least_amplitude"], 0.7 * kSlip);
    EXPECT_LT(reached["least_amplitude"], kSlip);
  }
  EXPECT_EQ(plan["loops"].size(), 26u);  // 13 amplitudes, two pasts
}

TEST(PlanCommand, ExitsWithThreeWhereNoAmplitudeDoes) {
  const Outcome outcome = RunPlan({"--force-noise", "0.4", "--want", "alpha=1e-6"});
  EXPECT_EQ(outcome.status, kNotEstablished);
  EXPECT_THAT(outcome.out, HasSubstr("no amplitude reaches it with 3 cycles"));
}

TEST(PlanCommand, ReadsNoColumnWithoutARecord) {
  for (const char* option : {"--displacement", "--force", "--time", "--normal-load-column"}) {
    const Outcome outcome = RunPlan({"--force-noise", "0.4", option, "1"});
    EXPECT_EQ(outcome.status, kBadInput) << option;
    EXPECT_THAT(outcome.err,
                HasSubstr(std::string(option) + " 1: there is no record to read a column of"));
  }
}

TEST(PlanCommand, ReadsARecordByTheColumnsAndUnitsOfAFit) {
  const TemporaryDirectory directory;
  const std::string clean = directory.path() / "clean.csv";
  ASSERT_EQ(RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "2",
                        "--cycles", "3", "--noise-force", "0.05", "-o", clean})
                .status,
            kDone);
  // The same in µm and mN, behind another column, without a header.
  std::ifstream in(clean);
  std::string text;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = testing::Cells(line);
    text += "7," + std::to_string(1e3 * std::stod(cells[2])) + "," +
            std::to_string(1e6 * std::stod(cells[1])) + "\n";
  }
  const std::string file = directory.Write("columns.csv", text).string();
  const Words columns = {"--displacement", "3 [um]", "--force", "2 [mN]"};
  const auto run = [&](const std::string& record, Words more) {
    more.insert(more.begin(), {"plan", "--record", record, "--json", "-"});
    const Outcome outcome = RunCommand(more);
    EXPECT_EQ(outcome.status, kDone) << outcome.err;
    return outcome.Json()["expected"]["slip_force"].get<double>();
  };
  EXPECT_NEAR(run(file, columns) / run(clean, {}), 1.0, 1e-4) << "six digits of the file";
  const Outcome assumed = RunCommand(
      {"plan", "--record", file, "--displacement", "3", "--force", "2 [mN]", "--amplitude", "1"});
  EXPECT_THAT(assumed.err, HasSubstr("plan: note: "));
  const Outcome refused =
      RunCommand({"plan", "--sigma", "4e7", "--slip-force", "40", "--force", "[kN]"});
  EXPECT_EQ(refused.status, kBadInput);
  EXPECT_THAT(refused.err, HasSubstr("--force [kN]"));
}

TEST(PlanCommand, DrawsTheErrors) {
  const TemporaryDirectory directory;
  const std::string file = directory.path() / "plan.svg";
  EXPECT_EQ(RunPlan({"--force-noise", "0.4", "--plot", file}).status, kDone);
  EXPECT_GT(std::filesystem::file_size(file), 1000u);
}

TEST(PlanCommand, RefusesWhatItDoesNotUnderstandInOneLine) {
  const std::vector<std::pair<Words, std::string>> cases = {
      {{}, "--force-noise missing"},
      {{"--force-noise", "0.4", "--want", "alpha"}, "--want: 'alpha' is no precision"},
      {{"--force-noise", "0.4", "--want", "alpha=1x"}, "--want: 'alpha=1x' is no precision"},
      {{"--force-noise", "0.4", "--want", "alpha=0"}, "is no precision"},
      {{"--force-noise", "0.4", "--want", "beta=1"}, "--want: 'beta' is no parameter"},
      {{"--force-noise", "0.4", "--want", "alpha=1,alpha=2"}, "alpha is given twice"},
  };
  for (const auto& [words, message] : cases) {
    const Outcome outcome = RunPlan(words);
    EXPECT_EQ(outcome.status, kBadInput) << message;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }
}

}  // namespace
}  // namespace mindahl::cli::plan_command_test
