#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <sstream>
#include <tuple>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// fit chooses between Masing's law and Dahl's own, and advises what it has tried.
namespace mindahl::cli::law_by_default_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

std::string Simulated(const TemporaryDirectory& directory, const Words& more) {
  const std::string path = (directory.path() / "loop.csv").string();
  Words words = {"simulate", "--sigma", "4e7", "--slip-force", "40", "--noise-force",
                 "0.1",      "-o",      path};
  words.insert(words.end(), more.begin(), more.end());
  EXPECT_EQ(RunCommand(words).status, kDone);
  return path;
}

json FitOf(const std::string& path, const Words& more = {}) {
  Words words = {"fit", path, "--json", "-"};
  words.insert(words.end(), more.begin(), more.end());
  const Outcome outcome = RunCommand(words);
  EXPECT_EQ(outcome.status, kDone) << outcome.err;
  return outcome.Json();
}

class LoopOfDahl : public ::testing::TestWithParam<std::tuple<double, double>> {};

// A noise of 0.25 % of Tc.
TEST_P(LoopOfDahl, IsFittedByItsLaw) {
  const auto& [alpha, cycles] = GetParam();
  const TemporaryDirectory directory;
  const json fit =
      FitOf(Simulated(directory, {"--model", "dahl", "--alpha", std::to_string(alpha),
                                  "--amplitude", "5e-6", "--cycles", std::to_string(cycles)}));
  EXPECT_EQ(fit["model"], "dahl");
  EXPECT_EQ(fit["adequacy"]["verdict"], "adequate");
  const auto value = [&](const char* name) {
    return fit["parameters"][name]["value"].get<double>();
  };
  EXPECT_NEAR(value("sigma") / 4e7, 1, 0.05);
  EXPECT_NEAR(value("alpha"), alpha, 0.06);
  EXPECT_NEAR(value("slip_force") / 40, 1, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Fit, LoopOfDahl,
                         ::testing::Combine(::testing::Values(0.5, 1.0, 1.5, 2.5),
                                            ::testing::Values(1.5, 2.25, 6.25)));

TEST(FitByDefault, TakesMasingsLawForAnUndecidedLoop) {
  const TemporaryDirectory directory;
  for (const char* cycles : {"1.5", "6.25"}) {
    EXPECT_EQ(FitOf(Simulated(directory, {"--lambda", "1.2", "--cycles", cycles}))["model"],
              "mindlin-dahl");
  }
  // Whole cycles of one amplitude are one curve under either law.
  const std::string path = Simulated(
      directory, {"--model", "dahl", "--alpha", "1", "--amplitude", "5e-6", "--cycles", "6"});
  EXPECT_EQ(FitOf(path, {"--initial-state", "steady", "--select", "cycles=2:5"})["model"],
            "mindlin-dahl");
}

TEST(NextStep, IsAStepThatWasTriedAndHelps) {
  const TemporaryDirectory directory;
  const Words clean = Lines(RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40",
                                        "--noise-force", "0.1", "--lambda", "2", "--cycles", "4"})
                                .out);
  // A force in proportion to the speed of the sine, 2 N at the most.
  std::string text = clean[0] + "\n";
  for (const std::string& line : Words(clean.begin() + 1, clean.end())) {
    const Words cells = Cells(line);
    const double viscous = 2 * std::cos(2 * M_PI * std::stod(cells[0]));
    text += fmt::format("{},{},{}\n", cells[0], cells[1], std::stod(cells[2]) + viscous);
  }
  const std::string path = directory.Write("viscous.csv", text).string();
  const json fit = FitOf(path);
  ASSERT_FALSE(fit["next"].is_null());
  const json& next = fit["next"];
  EXPECT_EQ(next["misfit_before"], fit["adequacy"]["misfit_over_half_gap"]);
  EXPECT_LT(next["misfit_after"].get<double>(), 0.9 * next["misfit_before"].get<double>());
  std::istringstream stream(next["options"].get<std::string>());
  const Words options{std::istream_iterator<std::string>(stream), {}};
  const json followed = FitOf(path, options);
  EXPECT_EQ(next["misfit_after"], followed["adequacy"]["misfit_over_half_gap"]);
  EXPECT_TRUE(FitOf(Simulated(directory, {"--lambda", "2", "--cycles", "4"}))["next"].is_null());
}

}  // namespace
}  // namespace mindahl::cli::law_by_default_test
