

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// simulate, contact and validate.
namespace mindahl::cli::other_commands_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

/// Columns of simulate's output, without the header.
struct Columns {
  std::vector<double> time, displacement, force;
};

Columns Parse(const std::string& text) {
  Columns columns;
  const Words lines = Lines(text);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Words cells = Cells(lines[i]);
    columns.time.push_back(std::stod(cells.at(0)));
    columns.displacement.push_back(std::stod(cells.at(1)));
    columns.force.push_back(std::stod(cells.at(2)));
  }
  return columns;
}

Columns Simulate(Words words) {
  words.insert(words.begin(), "simulate");
  const Outcome outcome = RunCommand(words);
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  return Parse(outcome.out);
}

// Closed forms below are evaluated in double from numbers of order one.
constexpr double kRounding = 1e-14;

TEST(Simulate, WritesTimeDisplacementAndForceWithUnits) {
  const Outcome outcome = RunCommand({"simulate", "--sigma", "2", "--slip-force", "3", "--lambda",
                                      "1", "--samples-per-cycle", "8", "--frequency", "4"});
  EXPECT_EQ(outcome.status, cli::kDone);
  EXPECT_THAT(outcome.err, IsEmpty());
  const Words lines = Lines(outcome.out);
  ASSERT_THAT(lines, SizeIs(10));
  EXPECT_EQ(lines[0], "time [s],displacement [m],force [N]");
  EXPECT_EQ(lines[1], "0,0,0");
  const Columns columns = Parse(outcome.out);
  // A quarter period on: δc = 3Tc/(2σ) = 2.25 m, where the force is Tc.
  EXPECT_DOUBLE_EQ(columns.time[2], 1.0 / 16);
  EXPECT_DOUBLE_EQ(columns.displacement[2], 2.25);
  EXPECT_DOUBLE_EQ(columns.force[2], 3.0);
}

TEST(Simulate, PathGivesOneRowAnInputRowInOrderWithEveryDigit) {
  const TemporaryDirectory directory;
  const Words inputs = {"0.30000000000000004", "-1.1234567890123457e-05", "0.7", "0.7", "-0.1",
                        "12345.678901234567"};
  std::string text;
  for (const std::string& input : inputs) text += input + "\n";
  const std::string path = directory.Write("path.csv", text).string();
  const Outcome outcome =
      RunCommand({"simulate", "--sigma", "2", "--slip-force", "1", "--path", path});
  ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
  const Columns columns = Parse(outcome.out);
  ASSERT_THAT(columns.displacement, SizeIs(inputs.size()));
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    EXPECT_EQ(columns.displacement[i], std::stod(inputs[i])) << "row " << i;
  }
  EXPECT_THAT(outcome.out, HasSubstr(",0.30000000000000004,"));
}

TEST(Simulate, FirstRowThatIsNotZeroIsTheFirstLoadingStep) {
  const TemporaryDirectory directory;
  const std::string path = directory.Write("path.csv", "0.4\n-0.1\n0.4\n5\n").string();
  const Columns columns = Simulate({"--sigma", "1", "--slip-force", "1", "--path", path});
  // T₀(δ) = 1 − (1 − 2δ/3)^{3/2}; from 0.4 down to −0.1 the branch is T₀(0.4) − 2T₀(0.25).
  const auto virgin = [](double x) { return 1 - std::pow(1 - 2 * x / 3, 1.5); };
  EXPECT_NEAR(columns.force[0], virgin(0.4), kRounding);
  EXPECT_NEAR(columns.force[1], virgin(0.4) - 2 * virgin(0.25), kRounding);
  EXPECT_NEAR(columns.force[2], virgin(0.4), kRounding) << "return-point memory";
  EXPECT_EQ(columns.force[3], 1.0);
}

TEST(Simulate, PathMayHaveAHeaderAUnitAndFurtherColumns) {
  const TemporaryDirectory directory;
  const std::string path = directory.Write("path.csv", "x [mm];other\n400;7\n-100;8\n").string();
  EXPECT_THAT(Simulate({"--sigma", "1", "--slip-force", "1", "--path", path}).displacement,
              ElementsAre(0.4, -0.1));
  const std::string bare = directory.Write("bare.csv", "4\n-1\n").string();
  EXPECT_THAT(
      Simulate({"--sigma", "1", "--slip-force", "1", "--path", bare, "--displacement", "[mm]"})
          .displacement,
      ElementsAre(0.004, -0.001));
}

TEST(Simulate, RandomWaveformIsThatOfItsSeed) {
  const auto with_seed = [](const char* seed) {
    return Simulate({"--sigma", "1", "--slip-force", "1", "--amplitude", "2", "--waveform",
                     "random", "--cycles", "9", "--seed", seed})
        .displacement;
  };
  const std::vector<double> drawn = with_seed("5");
  EXPECT_EQ(drawn, with_seed("5"));
  EXPECT_NE(drawn, with_seed("6"));
  const auto [least, greatest] = std::ranges::minmax(drawn);
  EXPECT_EQ(std::max(-least, greatest), 2.0);
}

TEST(Simulate, ContactGivesTheSameLoopAsItsParameters) {
  // σ = 8a/G* = 8·1e-3/4e-11 = 2e8, Tc = μN = 30.
  const Columns by_contact =
      Simulate({"--friction", "0.3", "--normal-load", "100", "--contact-radius", "1e-3",
                "--compliance", "4e-11", "--amplitude", "3e-7"});
  const Columns by_parameters =
      Simulate({"--sigma", "2e8", "--slip-force", "30", "--amplitude", "3e-7"});
  ASSERT_EQ(by_contact.force.size(), by_parameters.force.size());
  for (std::size_t i = 0; i < by_contact.force.size(); ++i) {
    EXPECT_NEAR(by_contact.force[i], by_parameters.force[i], 30 * kRounding);
  }
}

TEST(Simulate, WritesTheSameToAFileAsToStdout) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "loop.csv").string();
  const Words words = {"simulate", "--sigma", "1", "--slip-force", "1", "--lambda", "1"};
  Words to_file = words;
  to_file.insert(to_file.end(), {"-o", path});
  const Outcome outcome = RunCommand(to_file);
  EXPECT_EQ(outcome.status, cli::kDone);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(FileContent(path), RunCommand(words).out);
}

double Value(const json& contact, const char* section, const char* name) {
  return contact.at(section).at(name).at("value");
}

TEST(Contact, OfMaterialsAndRadiiFollowsHertzAndMindlin) {
  const Outcome outcome =
      RunCommand({"contact", "--friction", "0.4", "--normal-load", "25", "--youngs-modulus-1",
                  "210e9", "--poisson-1", "0.3", "--radius-1", "0.01", "--youngs-modulus-2", "70e9",
                  "--poisson-2", "0.34", "--radius-2", "-0.03", "--json", "-"});
  ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
  const json contact = outcome.Json();
  const double effective_modulus = 1 / ((1 - 0.09) / 210e9 + (1 - 0.34 * 0.34) / 70e9);
  const double equivalent_radius = 1 / (1 / 0.01 - 1 / 0.03);
  const double radius = std::cbrt(3 * 25 * equivalent_radius / (4 * effective_modulus));
  const double compliance = 1.7 * 2 * 1.3 / 210e9 + 1.66 * 2 * 1.34 / 70e9;  // (2−ν)/G, G=E/2(1+ν)
  EXPECT_NEAR(Value(contact, "contact", "effective_modulus") / effective_modulus, 1, kRounding);
  EXPECT_NEAR(Value(contact, "contact", "equivalent_radius") / equivalent_radius, 1, kRounding);
  EXPECT_NEAR(Value(contact, "contact", "contact_radius") / radius, 1, kRounding);
  EXPECT_NEAR(Value(contact, "contact", "compliance") / compliance, 1, kRounding);
  EXPECT_NEAR(Value(contact, "contact", "approach") / (radius * radius / equivalent_radius), 1,
              kRounding);
  EXPECT_NEAR(Value(contact, "parameters", "sigma") / (8 * radius / compliance), 1, kRounding);
  EXPECT_NEAR(Value(contact, "parameters", "slip_force") / 10, 1, kRounding);
}

TEST(Contact, PrintsEveryQuantityWithItsUnitAndDefinition) {
  const Outcome outcome = RunCommand({"contact", "--friction", "0.3", "--normal-load", "100",
                                      "--contact-radius", "1e-3", "--compliance", "4e-11"});
  EXPECT_EQ(outcome.status, cli::kDone);
  for (const char* text : {"sigma", "N/m", "8a/G*", "a compliance", "1/Pa", "Tc = mu N"}) {
    EXPECT_THAT(outcome.out, HasSubstr(text));
  }
}

TEST(Validate, PassesOnTwoRoundsOfTheAmplitudes) {
  const Outcome outcome = RunCommand({"validate", "--cases", "14", "--json", "-"});
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  const json report = outcome.Json();
  EXPECT_EQ(report["schema"], "mindahl.validate/1");
  EXPECT_EQ(report["passed"], true);
  EXPECT_EQ(report["failures"], 0);
  EXPECT_EQ(report["cases"], 14);
  EXPECT_EQ(report["fits"], 2 * 14 * 4) << "two laws, four noise levels";
  for (const char* rows : {"rows", "dahl_rows"}) {
    int fits = 0;
    for (const json& row : report[rows]) fits += row["cases"].get<int>();
    EXPECT_EQ(fits, 14 * 4) << rows;
  }
  ASSERT_EQ(report["coverage"].size(), 2U * 3U) << "two laws, three parameters";
  for (const json& verdict : report["coverage"]) {
    EXPECT_EQ(verdict["passed"], true) << verdict;
    EXPECT_GT(verdict["intervals"], verdict["sliding_intervals"]) << verdict;
  }
  EXPECT_TRUE(report["failed_coverages"].empty());
}

TEST(Validate, PrintsATableAndTheVerdict) {
  const Outcome outcome = RunCommand({"validate", "--cases", "1", "--seed", "9"});
  EXPECT_EQ(outcome.status, cli::kDone);
  EXPECT_THAT(outcome.out, HasSubstr("seed 9"));
  EXPECT_THAT(outcome.out, HasSubstr("by Dahl's own law, and translated"));
  EXPECT_THAT(outcome.out, HasSubstr("passed: every case within its tolerance"));
  EXPECT_EQ(outcome.err, "") << "no terminal that progress is shown on";
}

}  // namespace
}  // namespace mindahl::cli::other_commands_test
