
#include <fstream>
#include <iterator>
#include <sstream>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "mindahl/convert/conversion.h"
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

TEST(Convert, TakesLawAndAmplitudeOfAFitUnlessTheyAreGivenOrNotDetermined) {
  const TemporaryDirectory directory;
  const auto convert = [&](const std::string& text, Words more = {}) {
    const std::string file = directory.Write("written.json", text).string();
    more.insert(more.begin(), {"convert", file, "--to", "lammps", "--json", "-"});
    return RunCommand(more);
  };
  const auto fit = [](const std::string& verdict) {
    return R"({"schema": "mindahl.fit/2", "model": "dahl", "parameters": {
      "sigma": {"value": 5e7}, "alpha": {"value": 0.5, "identifiability": ")" +
           verdict + R"("}, "slip_force": {"value": 30}, "rig_stiffness": {"value": 1e8}},
      "measured": {"amplitude": 2e-6}})";
  };
  const json made = convert(fit("identifiable")).Json();
  EXPECT_EQ(made["from"],
            (json{{"law", "dahl"}, {"sigma", 5e7}, {"alpha", 0.5}, {"slip_force", 30.0}}));
  // The rest of the amplitude is the rig's: T* of the contact's part is that of the rig.
  const double amplitude = made["amplitude"];
  const double peak =
      models::SteadyPeakForce(*models::FindFrictionModel("dahl"), {5e7, 0.5, 30.0}, amplitude);
  EXPECT_NEAR(amplitude + peak / 1e8, 2e-6, 1e-15);
  const json given =
      convert(fit("identifiable"), {"--sigma", "6e7", "--amplitude", "1e-6", "--from", "masing"})
          .Json();
  EXPECT_EQ(given["from"]["sigma"], 6e7);
  EXPECT_EQ(given["from"]["law"], "masing");
  EXPECT_EQ(given["amplitude"], 1e-6);
  EXPECT_THAT(convert(fit("not_identifiable")).Errors(),
              ElementsAre(HasSubstr("written.json does not determine it: give it")));
  EXPECT_EQ(convert(fit("not_identifiable"), {"--alpha", "0.3"}).status, kDone);
  EXPECT_THAT(convert("x,F\n1,2\n").err, HasSubstr("is not the result of a fit"));
  EXPECT_THAT(convert("{}").err, HasSubstr("is not the result of a fit"));
}

TEST(Convert, OfAContactThatSticksHasNoRelativeErrorOfTheEnergy) {
  // Half of what Jenkins' element slips at.
  const Outcome outcome = RunCommand({"convert", "--sigma", "4e7", "--slip-force", "40", "--alpha",
                                      "0", "--amplitude", "5e-7", "--to", "lugre"});
  EXPECT_THAT(outcome.out, HasSubstr("the energy lost where the contact loses none\n"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("inf")));
}

TEST(Convert, IsOfTheLawThatItIsFrom) {
  const auto is_unchanged = [&](const char* from, const char* to) {
    const json made =
        RunCommand(Command({"--alpha", "0.5", "--from", from, "--to", to, "--json", "-"})).Json();
    EXPECT_LT(made["error_at_amplitude"]["force"], 1e-10) << "their steady loops are one curve";
    return Parameter(made, "sigma") == 4e7 && Parameter(made, "slip_force") == 40.0;
  };
  EXPECT_TRUE(is_unchanged("masing", "masing"));
  EXPECT_FALSE(is_unchanged("masing", "dahl"));
  EXPECT_FALSE(is_unchanged("dahl", "masing"));
  EXPECT_TRUE(is_unchanged("dahl", "dahl"));
}

TEST(Convert, RefusesWhatItsTargetHasNot) {
  const auto refusal = [](std::string_view to, const Words& more) {
    Words words = Command({"--to", std::string(to)});
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words).err;
  };
  for (const convert::TargetRow& row : convert::Targets()) {
    const std::string_view to = row.name;
    const bool is_code = to == "lammps" || to == "liggghts" || to == "yade";
    const bool moves =
        to == "lugre" || to == "mujoco" || to == "mujoco-joint" || to == "urdf" || to == "sdf";
    EXPECT_EQ(refusal(to, {"--normal-load", "10"}).empty(), is_code) << to;
    EXPECT_EQ(refusal(to, {"--contact-radius", "1e-3"}).empty(), to == "lammps") << to;
    EXPECT_EQ(refusal(to, {"--viscous", "2"}).empty(), moves) << to;
    EXPECT_EQ(refusal(to, {}), "") << to;
    EXPECT_THAT(refusal(to, {"--viscous", "-1"}), HasSubstr("--viscous [N s/m]"));
  }
}

}  // namespace
}  // namespace mindahl::cli::convert_command_test
