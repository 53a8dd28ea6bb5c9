
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

}  // namespace
}  // namespace mindahl::cli::convert_command_test
