#include <filesystem>

#include "cli/command_line.h"

// simulate, contact, validate and tradeoff.
namespace mindahl::cli::other_commands_test {
namespace {

using Simulate = CommandTest;
using Tradeoff = CommandTest;

// Closed forms below are evaluated in double from numbers of order one.
constexpr double kRounding = 1e-14;
const std::string kUnit = "simulate --sigma 1 --slip-force 1 ";

/// Columns of simulate's output.
std::vector<double> Displacements(const Words& words) { return Column(Done(words).out, 1); }
std::vector<double> Forces(const Words& words) { return Column(Done(words).out, 2); }

TEST_F(Simulate, WritesTimeDisplacementAndForceWithUnitsToAFileAsToStdout) {
  const std::string command =
      "simulate --sigma 2 --slip-force 3 --lambda 1 --samples-per-cycle 8 --frequency 4";
  const Outcome outcome = Done(command);
  EXPECT_THAT(outcome.err, IsEmpty());
  const auto lines = Lines(outcome.out);
  ASSERT_THAT(lines, SizeIs(10));
  EXPECT_EQ(lines[0], "time [s],displacement [m],force [N]");
  EXPECT_EQ(lines[1], "0,0,0");
  // A quarter period on: δc = 3Tc/(2σ) = 2.25 m, where the force is Tc.
  EXPECT_DOUBLE_EQ(Column(outcome.out, 0)[2], 1.0 / 16);
  EXPECT_DOUBLE_EQ(Column(outcome.out, 1)[2], 2.25);
  EXPECT_DOUBLE_EQ(Column(outcome.out, 2)[2], 3.0);
  EXPECT_THAT(Done(command + " -o " + Path("loop.csv")).out, IsEmpty());
  EXPECT_EQ(FileContent(Path("loop.csv")), outcome.out);
}

TEST_F(Simulate, GivesOneRowARowOfItsPathInOrderWithEveryDigit) {
  const std::string path =
      Write("path.csv", "0.30000000000000004\n-1.1234567890123457e-05\n0.7\n0.7\n-0.1\n");
  EXPECT_THAT(Displacements(kUnit + "--path " + path),
              ElementsAre(0.30000000000000004, -1.1234567890123457e-05, 0.7, 0.7, -0.1));
}

TEST_F(Simulate, TakesAFirstRowThatIsNotZeroForTheFirstLoadingStep) {
  const std::string path = Write("path.csv", "0.4\n-0.1\n0.4\n5\n");
  const std::vector<double> force = Forces(kUnit + "--path " + path);
  // T₀(δ) = 1 − (1 − 2δ/3)^{3/2}; from 0.4 down to −0.1 the branch is T₀(0.4) − 2T₀(0.25).
  const auto virgin = [](double x) { return 1 - std::pow(1 - 2 * x / 3, 1.5); };
  EXPECT_NEAR(force[0], virgin(0.4), kRounding);
  EXPECT_NEAR(force[1], virgin(0.4) - 2 * virgin(0.25), kRounding);
  EXPECT_NEAR(force[2], virgin(0.4), kRounding) << "return-point memory";
  EXPECT_EQ(force[3], 1.0);
}

TEST_F(Simulate, TakesAPathWithAHeaderAUnitAndFurtherColumns) {
  const std::string path = Write("path.csv", "x [mm];other\n400;7\n-100;8\n");
  EXPECT_THAT(Displacements(kUnit + "--path " + path), ElementsAre(0.4, -0.1));
  const std::string bare = Write("bare.csv", "4\n-1\n");
  EXPECT_THAT(Displacements(kUnit + "--displacement [mm] --path " + bare),
              ElementsAre(0.004, -0.001));
}

TEST_F(Simulate, AddsNoiseOfTheDeviationsThatAreAsked) {
  std::string rows = "x [um]\n";
  for (int i = 0; i < 4000; ++i) rows += i % 2 == 0 ? "0\n" : "1\n";
  const Words clean = ("simulate --path " + Write("path.csv", rows)) + kMindlinOptions;
  const Words noisy = clean + "--noise-force 0.5 --noise-displacement 2e-8";
  const auto deviation = [](const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(squares / static_cast<double>(a.size()));
  };
  // A deviation of 4000 is known to 1/√8000; five of that.
  constexpr double kScatter = 5 * 0.0112;
  EXPECT_NEAR(deviation(Forces(noisy), Forces(clean)) / 0.5, 1.0, kScatter);
  EXPECT_NEAR(deviation(Displacements(noisy), Displacements(clean)) / 2e-8, 1.0, kScatter);
  EXPECT_NE(Forces(noisy + "--seed 2"), Forces(noisy));
}

TEST_F(Simulate, ComesNearTheClosedFormByEveryMethod) {
  const std::vector<double> exact = Forces(kUnit + "--amplitude 1.2");
  EXPECT_EQ(Forces(kUnit + "--amplitude 1.2 --method exact"), exact);
  constexpr double kNear = 0.02;  // of Tc, at the methods' default resolution
  for (const char* method : {"dopri5", "iwan", "table"}) {
    const auto forces = Forces(kUnit + "--amplitude 1.2 --method " + method);
    EXPECT_NE(forces, exact) << method;
    EXPECT_THAT(forces, ::testing::Pointwise(::testing::DoubleNear(kNear), exact)) << method;
  }
}

TEST(Contact, OfMaterialsAndRadiiFollowsHertzAndMindlin) {
  const json contact = JsonOf(
      "contact --friction 0.4 --normal-load 25 --youngs-modulus-1 210e9 --poisson-1 0.3 "
      "--radius-1 0.01 --youngs-modulus-2 70e9 --poisson-2 0.34 --radius-2 -0.03");
  const double effective_modulus = 1 / ((1 - 0.09) / 210e9 + (1 - 0.34 * 0.34) / 70e9);
  const double equivalent_radius = 1 / (1 / 0.01 - 1 / 0.03);
  const double radius = std::cbrt(3 * 25 * equivalent_radius / (4 * effective_modulus));
  const double compliance = 1.7 * 2 * 1.3 / 210e9 + 1.66 * 2 * 1.34 / 70e9;  // (2−ν)/G, G=E/2(1+ν)
  for (const auto& [name, expected] : {std::pair("effective_modulus", effective_modulus),
                                       {"equivalent_radius", equivalent_radius},
                                       {"contact_radius", radius},
                                       {"compliance", compliance}}) {
    EXPECT_NEAR(contact["contact"][name]["value"].get<double>() / expected, 1, kRounding) << name;
  }
  EXPECT_NEAR(Value(contact, "sigma") / (8 * radius / compliance), 1, kRounding);
  EXPECT_NEAR(Value(contact, "slip_force") / 10, 1, kRounding);
}

TEST(Contact, PrintsEveryQuantityWithItsUnitAndDefinition) {
  const std::string text =
      Done("contact --friction 0.3 --normal-load 100 --contact-radius 1e-3 --compliance 4e-11").out;
  for (const char* part : {"sigma", "N/m", "8a/G*", "a compliance", "1/Pa", "Tc = mu N"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST(Validate, PassesOnTwoRoundsOfTheAmplitudes) {
  const json report = JsonOf("validate --cases 14");
  EXPECT_EQ(report["schema"], "mindahl.validate/1");
  EXPECT_EQ(report["passed"], true);
  EXPECT_EQ(report["failures"], 0);
  EXPECT_EQ(report["cases"], 14);
  EXPECT_EQ(report["fits"], 14 * 4) << "four noise levels";
  ASSERT_EQ(report["rows"].size(), 4U * 7U) << "four noise levels, seven amplitudes";
}

TEST(Validate, PrintsATableAndTheVerdict) {
  const Outcome outcome = Done("validate --cases 1 --seed 9");
  EXPECT_THAT(outcome.out, HasSubstr("seed 9"));
  EXPECT_THAT(outcome.out, HasSubstr("with free alpha: 4 fits"));
  EXPECT_THAT(outcome.out, HasSubstr("passed: every case within its tolerance"));
  EXPECT_EQ(outcome.err, "") << "no terminal that progress is shown on";
}

TEST_F(Tradeoff, WritesTableCsvAndPlot) {
  const std::string text =
      Done("tradeoff --csv " + Path("points.csv") + " --plot " + Path("points.svg")).out;
  EXPECT_THAT(text, HasSubstr("\n  simplified-dahl  exact "));
  EXPECT_THAT(Lines(FileContent(Path("points.csv"))), SizeIs(1 + 3 * (4 + 15)));
  EXPECT_THAT(FileContent(Path("points.svg")), HasSubstr("<svg"));
}

TEST_F(Tradeoff, NamesTheCheapestAlongAPath) {
  const auto cheapest = [&](const std::string& lambda) {
    // The column is found by its name, whichever it is.
    std::string path;
    for (const auto& cells : testing::Rows(Done(kUnit + "--cycles 3 --lambda " + lambda).out)) {
      path += cells[2] + "," + cells[1] + "\n";
    }
    return JsonOf("tradeoff --sigma 1 --slip-force 1 --tolerance 1% --path " +
                  Write("path.csv", path))["excitations"][0]["cheapest"];
  };
  EXPECT_EQ(cheapest("1e-3")["model"], "simplified-dahl");  // Jenkins' would lose the energy
  EXPECT_EQ(cheapest("1e6")["model"], "jenkins");
  EXPECT_EQ(cheapest("0.8")["method"], "exact");
}

}  // namespace
}  // namespace mindahl::cli::other_commands_test
