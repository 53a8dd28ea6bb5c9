
#include <filesystem>
#include <fstream>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "mindahl/identification/plan.h"
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
    EXPECT_THAT(outcome.err, HasSubstr(std::string(option) + " requires --record"));
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
  EXPECT_THAT(assumed.out, HasSubstr("\nnote: "));
  const Outcome refused =
      RunCommand({"plan", "--sigma", "4e7", "--slip-force", "40", "--force", "[kN]"});
  EXPECT_EQ(refused.status, kBadInput);
  EXPECT_THAT(refused.err, HasSubstr("--force requires --record"));
}

TEST(PlanCommand, DrawsTheErrors) {
  const TemporaryDirectory directory;
  const std::string file = directory.path() / "plan.svg";
  EXPECT_EQ(RunPlan({"--force-noise", "0.4", "--plot", file}).status, kDone);
  EXPECT_GT(std::filesystem::file_size(file), 1000u);
}

/// One steady loop of a contact that is known, with noise of 0.2 N.
json Planned(Words more) {
  more.insert(more.begin(), {"--force-noise", "0.2", "--amplitude", "2e-6", "--initial-state",
                             "steady", "--samples-per-cycle", "60", "--json", "-"});
  const Outcome outcome = RunPlan(more);
  EXPECT_EQ(outcome.status, kDone) << outcome.err;
  return outcome.Json();
}

TEST(PlanCommand, CountsAmplitudesInDisplacementsAtSlip) {
  constexpr double kRounding = 1e-18;
  const auto slip = [](const Words& more) {
    return Planned(more)["expected"]["gross_slip_displacement"].get<double>();
  };
  EXPECT_NEAR(slip({}), 1.5e-6, kRounding);  // Tc/(σ(1 − α))
  // The rig deflects by Tc/k; slip that is only approached counts as three elastic limits.
  EXPECT_NEAR(slip({"--rig-stiffness", "8e7"}), 1.5e-6 + 0.5e-6, kRounding);
  EXPECT_NEAR(slip({"--rig-stiffness", "8e7", "--alpha", "1"}), 3e-6 + 0.5e-6, kRounding);
  EXPECT_NEAR(slip({"--alpha", "1"}), 3e-6, kRounding);
}

TEST(PlanCommand, ExpectsTheErrorsOfItsProtocol) {
  const json plan = Planned({"--rig-stiffness", "8e7", "--with", "viscous", "--displacement-noise",
                             "2e-9", "--cycles", "2"});
  identification::Expectation expected;
  expected.law = {4e7, 1.0 / 3, 40.0};
  expected.rig.stiffness = 8e7;
  expected.force_noise = 0.2;
  expected.displacement_noise = 2e-9;
  const identification::ExpectedFit fit =
      identification::ExpectFit(expected,
                                {.amplitude = 2e-6,
                                 .cycles = 2,
                                 .samples_per_cycle = 60,
                                 .initial_state = models::InitialState::kSteady},
                                {.terms = {"viscous"}});
  const json& loop = plan["loops"].at(0);
  EXPECT_EQ(loop["initial_state"], "steady");
  EXPECT_EQ(loop["amplitude"], 2e-6);
  EXPECT_EQ(loop["peak_force"], fit.peak_force);
  for (const char* name : {"sigma", "alpha", "slip_force", "viscous"}) {
    EXPECT_EQ(loop["parameters"][name]["value"], fit.Find(name)->value) << name;
    EXPECT_EQ(loop["parameters"][name]["standard_error"], *fit.Find(name)->standard_error) << name;
  }
  EXPECT_EQ(plan["expected"]["rig_stiffness"], 8e7);
  EXPECT_EQ(plan["expected"]["displacement_noise"], 2e-9);
  EXPECT_EQ(plan["protocol"]["cycles"], 2.0);
}

TEST(PlanCommand, TakesTheLawOfItsRecordAndSaysWhatIsNotKnown) {
  const TemporaryDirectory directory;
  const std::string loop = directory.path() / "loop.csv";
  const auto plan = [&](const char* lambda, const Words& more) {
    RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", lambda, "--cycles",
                "3", "--noise-force", "0.2", "-o", loop});
    Words words = {"plan", "--record", loop, "--amplitude", "3e-6", "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words).Json();
  };
  const json held = plan("2", {"--alpha", "0.25", "--force-noise", "0.75"});
  EXPECT_EQ(held["expected"]["alpha"], 0.25);
  EXPECT_NEAR(held["expected"]["slip_force"], 40.0, 1.0);  // at another α, a little off
  EXPECT_EQ(held["expected"]["force_noise"], 0.75);
  const json guessed = plan("0.02", {});
  EXPECT_EQ(guessed["expected"]["alpha"], 1.0 / 3);
  EXPECT_THAT(guessed["notes"].get<Words>(),
              Contains(HasSubstr("alpha is not identified: Mindlin's 1/3 is assumed")));
}

TEST(PlanCommand, RefusesWhatItDoesNotUnderstandInOneLine) {
  const std::vector<std::pair<Words, std::string>> cases = {
      {{}, "--force-noise missing"},
      {{"--force-noise", "0.4", "--want", "alpha"}, "--want: 'alpha' is no precision"},
      {{"--force-noise", "0.4", "--want", "alpha=1x"}, "--want: 'alpha=1x' is no precision"},
      {{"--force-noise", "0.4", "--want", "alpha=0"}, "is no precision"},
      {{"--force-noise", "0.4", "--want", "beta=1"}, "--want: 'beta' is no parameter"},
      {{"--force-noise", "0.4", "--want", "alpha=1,alpha=2"}, "alpha is given twice"},
      {{"--force-noise", "0.4", "--with", "inertia"}, "--with"},
      {{"--force-noise", "0.4", "--with", "rig_stiffness"}, "needs --rig-stiffness"},
      {{"--force-noise", "0.4", "--displacement-noise", "-1"}, "--displacement-noise [m]"},
      {{"--record", "loop.csv"}, "--record excludes --sigma"},
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
