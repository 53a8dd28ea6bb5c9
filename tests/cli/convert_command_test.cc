
#include <fstream>
#include <iterator>
#include <sstream>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

namespace mindahl::cli::convert_command_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

constexpr models::BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kAmplitude = 1.2e-6;

Words Command(const Words& more) {
  Words words = {"convert", "--sigma", "4e7", "--slip-force", "40", "--amplitude", "1.2e-6"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

double Parameter(const json& report, const char* name) {
  return report["parameters"][name]["value"].get<double>();
}

TEST(Convert, ToDahlGivesTheLawOfTheSameSteadyLoop) {
  const json report = RunCommand(Command({"--to", "dahl", "--json", "-"})).Json();
  EXPECT_EQ(report["schema"], "mindahl.convert/1");
  EXPECT_EQ(report["to"], "dahl");
  EXPECT_EQ(report["from"]["law"], "masing");
  const models::BranchLaw dahl = models::DahlEquivalent(kMindlin, kAmplitude);
  EXPECT_EQ(Parameter(report, "sigma"), dahl.tangential_stiffness);
  EXPECT_EQ(Parameter(report, "alpha"), kMindlin.shape_exponent);
  EXPECT_EQ(Parameter(report, "slip_force"), dahl.slip_force);
  EXPECT_LT(report["error_at_amplitude"]["force"].get<double>(), 1e-13);
  EXPECT_LT(report["within"][0].get<double>(), kAmplitude);
  EXPECT_GT(report["within"][1].get<double>(), kAmplitude);
  // And there is a way back.
  const json back = RunCommand({"convert", "--from", "dahl", "--sigma",
                                report["parameters"]["sigma"]["value"].dump(), "--alpha",
                                report["parameters"]["alpha"]["value"].dump(), "--slip-force",
                                report["parameters"]["slip_force"]["value"].dump(), "--amplitude",
                                "1.2e-6", "--to", "masing", "--json", "-"})
                        .Json();
  // As tests/models/equivalent_law_test.cc has it.
  constexpr double kBack = 64 * std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(Parameter(back, "sigma") / 4e7, 1.0, kBack);
  EXPECT_NEAR(Parameter(back, "slip_force") / 40, 1.0, kBack);
}

TEST(Convert, PrintsParametersErrorsAndTheRange) {
  const Outcome outcome = RunCommand(Command({"--to", "dahl"}));
  EXPECT_EQ(outcome.status, kDone);
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(
      outcome.out,
      StartsWith(
          "Dahl's own law; at 1.2e-06 m the force is within 0 % of T*, the energy off by 0 %\n"));
  EXPECT_THAT(outcome.out, HasSubstr("force and energy within 1 % from "));
  EXPECT_THAT(RunCommand(Command({"--to", "lammps"})).out, HasSubstr("not within 1 %"));
}

TEST(Convert, WritesElementsAsOpenSeesReadsThem) {
  const TemporaryDirectory directory;
  const std::string file = directory.path() / "contact.tcl";
  const Outcome outcome =
      RunCommand(Command({"--to", "iwan", "--elements", "3", "--input-lines", file}));
  EXPECT_EQ(outcome.status, kDone);
  EXPECT_THAT(outcome.out, HasSubstr("element"));  // the text goes on besides
  std::ifstream input(file);
  const std::string lines{std::istreambuf_iterator<char>(input), {}};
  const json report =
      RunCommand(Command({"--to", "iwan", "--elements", "3", "--json", "-"})).Json();
  ASSERT_EQ(report["elements"].size(), 3U);
  std::size_t found = 0;
  std::istringstream text(lines);
  for (std::string word; text >> word;) {
    if (word != "ElasticPP") continue;
    std::size_t tag = 0;
    double stiffness = 0.0;
    double travel = 0.0;
    text >> tag >> stiffness >> travel;
    const json& element = report["elements"][found++];
    EXPECT_EQ(tag, found);
    EXPECT_DOUBLE_EQ(stiffness, element["stiffness"].get<double>());
    EXPECT_DOUBLE_EQ(stiffness * travel, element["slip_force"].get<double>());
  }
  EXPECT_EQ(found, 3U);
  EXPECT_THAT(lines, HasSubstr("uniaxialMaterial Parallel 4 1 2 3\n"));
}

TEST(Convert, WritesBoucAndWensLawWithItsOwnGammaAndBeta) {
  const Words words = Command({"--to", "bouc-wen", "--beta", "0.7"});
  Words as_json = words;
  as_json.insert(as_json.end(), {"--json", "-"});
  const json report = RunCommand(as_json).Json();
  const double beta = Parameter(report, "beta");
  const double gamma = Parameter(report, "gamma");
  const double exponent = Parameter(report, "n");
  // z* = (β + γ)^{−1/n} is where dz/dx = A − (β + γ)·zⁿ vanishes; kz* is the slip force.
  EXPECT_NEAR(Parameter(report, "k") * std::pow(beta + gamma, -1 / exponent) /
                  Parameter(report, "slip_force"),
              1.0, 1e-12);
  EXPECT_NEAR(beta / (beta + gamma), 0.7, 1e-12);
  Words as_lines = words;
  as_lines.insert(as_lines.end(), {"--input-lines", "-"});
  const std::string lines = RunCommand(as_lines).out;
  EXPECT_THAT(lines,
              AllOf(StartsWith("# at 1.2e-06 m the force is within "), HasSubstr("\n# OpenSees")));
  std::istringstream text(lines.substr(lines.find("BoucWen 1 0.0 ") + 14));
  double ko = 0.0;
  double n = 0.0;
  double first = 0.0;
  double second = 0.0;
  text >> ko >> n >> first >> second;
  EXPECT_DOUBLE_EQ(ko, Parameter(report, "k"));
  EXPECT_DOUBLE_EQ(first, gamma);
  EXPECT_DOUBLE_EQ(second, beta);
}

TEST(Convert, WritesASpringForDiscreteElements) {
  const Words words =
      Command({"--to", "lammps", "--normal-load", "100", "--contact-radius", "2e-4"});
  Words as_json = words;
  as_json.insert(as_json.end(), {"--json", "-"});
  const json report = RunCommand(as_json).Json();
  EXPECT_DOUBLE_EQ(Parameter(report, "mu"), Parameter(report, "slip_force") / 100);
  EXPECT_DOUBLE_EQ(Parameter(report, "kt_mindlin"), Parameter(report, "kt") / 2e-4);
  // Softer than Mindlin's at rest, and it slips at the amplitude: else it would lose nothing.
  EXPECT_LT(Parameter(report, "kt"), 4e7);
  EXPECT_LT(Parameter(report, "slip_force") / Parameter(report, "kt"), kAmplitude);
  Words as_lines = words;
  as_lines.insert(as_lines.end(), {"--input-lines", "-"});
  const std::string lines = RunCommand(as_lines).out;
  EXPECT_THAT(lines, HasSubstr("\ntangential linear_history "));
  EXPECT_THAT(lines, HasSubstr("\ntangential mindlin "));
}

TEST(Convert, ToLuGreHasNoRate) {
  const json report = RunCommand(Command({"--to", "lugre", "--json", "-"})).Json();
  EXPECT_EQ(Parameter(report, "sigma1"), 0.0);
  EXPECT_EQ(Parameter(report, "sigma2"), 0.0);
  EXPECT_EQ(Parameter(report, "Fs"), Parameter(report, "Fc"));
}

TEST(Convert, TakesAFit) {
  const TemporaryDirectory directory;
  const std::string fit = directory.path() / "fit.json";
  ASSERT_EQ(RunCommand({"fit", SampleRecord(), "--json", fit}).status, kDone);
  const json made = RunCommand({"convert", fit, "--to", "dahl", "--json", "-"}).Json();
  const json fitted = json::parse(FileContent(fit));
  EXPECT_EQ(made["from"]["sigma"], fitted["parameters"]["sigma"]["value"]);
  EXPECT_EQ(made["from"]["slip_force"], fitted["parameters"]["slip_force"]["value"]);
  EXPECT_GT(made["amplitude"], 0.0);
  const Outcome none = RunCommand({"convert", "--to", "dahl"});
  EXPECT_EQ(none.status, kBadInput);
  EXPECT_THAT(none.Errors(),
              ElementsAre(HasSubstr("--sigma missing: give it, or the JSON file of a fit")));
}

TEST(Convert, TakesItsOptionsFromAFile) {
  const TemporaryDirectory directory;
  const std::string file = directory.Write(
      "convert.toml", "sigma = 4e7\nslip-force = 40\namplitude = 1.2e-6\nto = \"dahl\"\n");
  EXPECT_EQ(RunCommand({"convert", "--config", file}).out,
            RunCommand(Command({"--to", "dahl"})).out);
}

}  // namespace
}  // namespace mindahl::cli::convert_command_test
