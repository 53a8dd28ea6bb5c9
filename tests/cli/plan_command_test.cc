#include <filesystem>

#include "cli/command_line.h"
#include "mindahl/identification/plan.h"

namespace mindahl::cli::plan_command_test {
namespace {

using PlanCommand = CommandTest;

Words Plan(const Words& more) { return "plan" + kMindlinOptions + more; }

TEST_F(PlanCommand, ReportsAndDrawsTheAmplitudeThatReachesTheWantedPrecision) {
  const Words command = Plan("--force-noise 0.4 --want alpha=0.01,slip_force=1%");
  const json plan = JsonOf(command + Words{"--plot", Path("plan.svg")});
  EXPECT_EQ(plan["schema"], "mindahl.plan/1");
  constexpr double kSlip = 1.5e-6;
  EXPECT_GT(plan["reached"]["least_amplitude"], 0.7 * kSlip);
  EXPECT_LT(plan["reached"]["least_amplitude"], kSlip);
  EXPECT_EQ(plan["loops"].size(), 13u);
  EXPECT_GT(std::filesystem::file_size(Path("plan.svg")), 1000u);
}

TEST_F(PlanCommand, ExitsWithThreeWhereNoAmplitudeDoes) {
  const Outcome outcome = RunCommand(Plan("--force-noise 0.4 --want alpha=1e-6"));
  EXPECT_EQ(outcome.status, kNotEstablished);
  EXPECT_THAT(outcome.out, ::testing::ContainsRegex("\n +- +[0-9]"));
}

TEST_F(PlanCommand, RecommendsAMarginBeyondSlipOfASharpKnee) {
  // 3 % short of slip the error of Tc is 2.7 % for α = 0.05, thirty times that at slip, and 0.2 %
  // for α = 1/3: an amplitude at slip reaches 1 % only where a smaller one does.
  const auto is_reached = [](double alpha, double over_slip) {
    const double slip = 1e-6 / (1 - alpha);  // Tc/(σ(1 − α))
    const Outcome outcome =
        RunCommand("plan --sigma 4e7 --slip-force 40 --force-noise 0.4 --want slip_force=1%" +
                   Words{"--alpha", fmt::format("{}", alpha), "--amplitude",
                         fmt::format("{}", over_slip * slip)});
    EXPECT_THAT(outcome.status, ::testing::AnyOf(kDone, kNotEstablished));
    return outcome.status == kDone;
  };
  for (const double over_slip : {1.0001, 1.01, 1.04}) {
    EXPECT_EQ(is_reached(0.05, over_slip), over_slip > 1.03) << over_slip;
    EXPECT_TRUE(is_reached(1.0 / 3, over_slip)) << over_slip;
  }
}

TEST_F(PlanCommand, PlansForDahlsOwnLaw) {
  const Words loop = "--sigma 2500 --alpha 1 --slip-force 3 --force-noise 0.015 --amplitude 0.0036";
  const auto error = [&](const Words& more) {
    const json plan = JsonOf("plan" + loop + more);
    return plan["loops"][0]["parameters"]["slip_force"]["standard_error"].get<double>();
  };
  identification::Expectation expected{
      .law = {2500, 1, 3}, .model = models::FindFrictionModel("dahl"), .force_noise = 0.015};
  EXPECT_NEAR(error("--model dahl") / *identification::ExpectFit(expected, {.amplitude = 0.0036})
                                           .Find("slip_force")
                                           ->standard_error,
              1.0, 1e-9);
  EXPECT_LT(error("--model dahl"), 0.5 * error({}));
  EXPECT_EQ(JsonOf("plan" + loop + "--model dahl")["expected"]["model"], "dahl");
  EXPECT_EQ(RunCommand("plan --record x.csv --model dahl").status, kBadInput);
}

TEST_F(PlanCommand, ReadsARecordByTheColumnsAndUnitsOfAFit) {
  const std::string clean = Simulated("--lambda 2 --cycles 3 --noise-force 0.05", "clean.csv");
  // The same in µm and mN, behind another column, without a header.
  std::string text;
  for (const auto& row : testing::Numbers(FileContent(clean))) {
    text += fmt::format("7,{},{}\n", 1e3 * row[2], 1e6 * row[1]);
  }
  const std::string file = Write("columns.csv", text);
  const auto slip_force = [](const Words& plan) {
    return JsonOf(plan)["expected"]["slip_force"].get<double>();
  };
  EXPECT_NEAR(
      slip_force({"plan", "--record", file, "--displacement", "3 [um]", "--force", "2 [mN]"}) /
          slip_force("plan --record " + clean),
      1.0, 1e-9);
  EXPECT_THAT(Done({"plan", "--record", file, "--displacement", "3", "--force", "2 [mN]",
                    "--amplitude", "1"})
                  .out,
              HasSubstr("\nnote: "));
}

/// Loops of a contact that is known, with noise of 0.2 N.
json Planned(const Words& more) {
  return JsonOf(Plan("--force-noise 0.2 --amplitude 2e-6 --samples-per-cycle 60") + more);
}

TEST_F(PlanCommand, CountsAmplitudesInDisplacementsAtSlip) {
  constexpr double kRounding = 1e-18;
  const auto slip = [](const Words& more) {
    return Planned(more)["expected"]["gross_slip_displacement"].get<double>();
  };
  EXPECT_NEAR(slip({}), 1.5e-6, kRounding);  // Tc/(σ(1 − α))
  // The rig deflects by Tc/k; slip that is only approached counts as three elastic limits.
  EXPECT_NEAR(slip("--rig-stiffness 8e7"), 1.5e-6 + 0.5e-6, kRounding);
  EXPECT_NEAR(slip("--rig-stiffness 8e7 --alpha 1"), 3e-6 + 0.5e-6, kRounding);
  EXPECT_NEAR(slip("--alpha 1"), 3e-6, kRounding);
}

TEST_F(PlanCommand, ExpectsTheErrorsOfItsProtocol) {
  const json plan = Planned("--rig-stiffness 8e7 --displacement-noise 2e-9 --cycles 2");
  identification::Expectation expected;
  expected.law = kMindlin;
  expected.rig.stiffness = 8e7;
  expected.force_noise = 0.2;
  expected.displacement_noise = 2e-9;
  const identification::ExpectedFit fit = identification::ExpectFit(
      expected, {.amplitude = 2e-6, .cycles = 2, .samples_per_cycle = 60});
  const json& loop = plan["loops"].at(0);
  EXPECT_EQ(loop["amplitude"], 2e-6);
  EXPECT_EQ(loop["peak_force"], fit.peak_force);
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    EXPECT_EQ(loop["parameters"][name]["value"], fit.Find(name)->value) << name;
    EXPECT_EQ(loop["parameters"][name]["standard_error"], *fit.Find(name)->standard_error) << name;
  }
  EXPECT_EQ(plan["expected"]["rig_stiffness"], 8e7);
  EXPECT_EQ(plan["expected"]["displacement_noise"], 2e-9);
}

TEST_F(PlanCommand, TakesTheLawOfItsRecordAndSaysWhatIsNotKnown) {
  const auto plan = [&](const std::string& lambda, const Words& more) {
    const std::string loop = Simulated("--cycles 3 --noise-force 0.2 --lambda " + lambda);
    return JsonOf(("plan --amplitude 3e-6 --record " + loop) + more);
  };
  const json known = plan("2", "--force-noise 0.75");
  EXPECT_NEAR(known["expected"]["alpha"], 1.0 / 3, 0.02);
  EXPECT_NEAR(known["expected"]["slip_force"], 40.0, 0.2);
  EXPECT_EQ(known["expected"]["force_noise"], 0.75);
  const json guessed = plan("0.02", {});
  EXPECT_EQ(guessed["expected"]["alpha"], 1.0 / 3);
  EXPECT_THAT(guessed["notes"].get<std::vector<std::string>>(),
              Contains(HasSubstr("alpha is not identified: Mindlin's 1/3 is assumed")));
}

TEST_F(PlanCommand, OfARecordOfDahlsLawHasLoopsOfThat) {
  const std::string loop =
      Simulated("--model dahl --alpha 0.5 --amplitude 1.2e-6 --cycles 3 --noise-force 0.1");
  const json plan = JsonOf("plan --amplitude 3e-6 --record " + loop);
  EXPECT_NEAR(plan["expected"]["sigma"].get<double>() / 4e7, 1, 0.01);
  EXPECT_NEAR(plan["expected"]["alpha"], 0.5, 0.03);
  const double slip_force = plan["expected"]["slip_force"];
  EXPECT_NEAR(slip_force, 40.0, 1.0);
  const models::BranchLaw law{plan["expected"]["sigma"], plan["expected"]["alpha"], slip_force};
  EXPECT_NEAR(plan["loops"][0]["peak_force"].get<double>() /
                  models::SteadyPeakForce(*models::FindFrictionModel("dahl"), law, 3e-6),
              1, 1e-3);
}

TEST_F(PlanCommand, CountsAutocorrelatedNoiseAsTheWhiteNoiseOfAsLargeErrors) {
  const std::string clean = FileContent(Simulated("--lambda 2 --cycles 4 --samples-per-cycle 200"));
  std::vector<std::string> lines = Lines(clean);
  testing::Generator generator(1);
  double noise = 0.0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    noise = 0.9 * noise + 0.1 * testing::Normal(generator);
    lines[i] += fmt::format(",{}", std::stod(lines[i].substr(lines[i].rfind(',') + 1)) + noise);
  }
  lines[0] += ",noisy [N]";
  const std::string file = Write("slow.csv", fmt::format("{}\n", fmt::join(lines, "\n")));
  const json plan = JsonOf("plan --amplitude 3e-6 --cycles 4 --force noisy --record " + file);
  const json fit = JsonOf("fit --force noisy " + file);
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    const double planned = plan["loops"][0]["parameters"][name]["standard_error"];
    EXPECT_NEAR(planned / fit["parameters"][name]["standard_error"].get<double>(), 1, 0.5) << name;
  }
  EXPECT_THAT(plan["notes"].get<std::vector<std::string>>(),
              Contains(HasSubstr("the noise is autocorrelated: 0.2")));
}

}  // namespace
}  // namespace mindahl::cli::plan_command_test
