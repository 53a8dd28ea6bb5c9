#include "cli/command_line.h"
#include "mindahl/convert/conversion.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::cli::convert_command_test {
namespace {

using Convert = CommandTest;

constexpr double kAmplitude = 1.2e-6;

Words Command(const Words& more) { return "convert --amplitude 1.2e-6" + kMindlinOptions + more; }

TEST_F(Convert, ToDahlGivesTheLawOfTheSameSteadyLoop) {
  const json report = JsonOf(Command("--to dahl"));
  EXPECT_EQ(report["schema"], "mindahl.convert/1");
  EXPECT_EQ(report["to"], "dahl");
  EXPECT_EQ(report["from"]["law"], "masing");
  const models::BranchLaw dahl = models::DahlEquivalent(kMindlin, kAmplitude);
  EXPECT_EQ(Value(report, "sigma"), dahl.tangential_stiffness);
  EXPECT_EQ(Value(report, "alpha"), kMindlin.shape_exponent);
  EXPECT_EQ(Value(report, "slip_force"), dahl.slip_force);
  EXPECT_LT(report["error_at_amplitude"]["force"].get<double>(), 1e-13);
  EXPECT_LT(report["within"][0].get<double>(), kAmplitude);
  EXPECT_GT(report["within"][1].get<double>(), kAmplitude);
}

TEST_F(Convert, WritesElementsAsOpenSeesReadsThem) {
  const Words command = Command("--to iwan --elements 3");
  const std::string file = Path("contact.tcl");
  EXPECT_THAT(Done(command + Words{"--input-lines", file}).out, HasSubstr("element"))
      << "the text goes on besides";
  const json report = JsonOf(command);
  ASSERT_EQ(report["elements"].size(), 3U);
  std::size_t found = 0;
  std::istringstream text(FileContent(file));
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
  EXPECT_THAT(FileContent(file), HasSubstr("uniaxialMaterial Parallel 4 1 2 3\n"));
}

TEST_F(Convert, TakesAFit) {
  const json fitted = JsonOf("fit " + SampleRecord());
  const json made = JsonOf("convert --to dahl " + Write("fit.json", fitted.dump()));
  EXPECT_EQ(made["from"]["sigma"], Value(fitted, "sigma"));
  EXPECT_EQ(made["from"]["slip_force"], Value(fitted, "slip_force"));
  EXPECT_GT(made["amplitude"], 0.0);
}

TEST_F(Convert, SaysWhereTheFitIsNotAdequate) {
  json fit = JsonOf("fit " + SampleRecord());
  const auto notes = [&] { return Done("convert --to dahl " + Write("fit.json", fit.dump())).err; };
  EXPECT_THAT(notes(), Not(HasSubstr("the fit is")));
  fit["adequacy"]["verdict"] = "doubtful";
  EXPECT_THAT(notes(), HasSubstr("the fit is doubtful: its values are converted"));
}

TEST_F(Convert, FitsARecordWithTheColumnsThatAreChosen) {
  const json fitted = JsonOf("fit " + SampleRecord());
  const json made = JsonOf("convert --to dahl --displacement 2 --force 3 " + SampleRecord());
  EXPECT_EQ(made["from"]["sigma"], Value(fitted, "sigma"));
  EXPECT_EQ(made["from"]["slip_force"], Value(fitted, "slip_force"));
}

TEST_F(Convert, SaysWhatWasAssumedOfARecord) {
  std::string text = "x,F\n";
  for (const auto& row : testing::Numbers(FileContent(SampleRecord()))) {
    text += fmt::format("{},{}\n", 1e9 * row[1], row[2]);
  }
  const std::string said = Done("convert --to dahl " + Write("counts.csv", text)).err;
  EXPECT_THAT(said, HasSubstr("force 'F' (column 2) names no unit: taken as N"));
  EXPECT_THAT(said, HasSubstr("or the gain of counts and volts, --displacement '#1*GAIN [m]'"));
}

TEST_F(Convert, TakesLawAndAmplitudeOfAFitUnlessTheyAreGivenOrNotDetermined) {
  const auto command = [&](const std::string& text) {
    return "convert --to lammps " + Write("written.json", text) + " ";
  };
  const auto fit = [](const std::string& verdict) {
    return R"({"schema": "mindahl.fit/2", "model": "dahl", "parameters": {
      "sigma": {"value": 5e7}, "alpha": {"value": 0.5, "identifiability": ")" +
           verdict + R"("}, "slip_force": {"value": 30}, "rig_stiffness": {"value": 1e8}},
      "measured": {"amplitude": 2e-6}})";
  };
  const json made = JsonOf(command(fit("identifiable")));
  EXPECT_EQ(made["from"],
            (json{{"law", "dahl"}, {"sigma", 5e7}, {"alpha", 0.5}, {"slip_force", 30.0}}));
  // The rest of the amplitude is the rig's: T* of the contact's part is that of the rig.
  const double amplitude = made["amplitude"];
  const double peak = models::SteadyPeakForce(testing::Model("dahl"), {5e7, 0.5, 30.0}, amplitude);
  EXPECT_NEAR(amplitude + peak / 1e8, 2e-6, 1e-15);
  const json given =
      JsonOf(command(fit("identifiable")) + "--sigma 6e7 --amplitude 1e-6 --from masing");
  EXPECT_EQ(given["from"]["sigma"], 6e7);
  EXPECT_EQ(given["from"]["law"], "masing");
  EXPECT_EQ(given["amplitude"], 1e-6);
  ExpectRefused(command(fit("not_identifiable")),
                "--alpha missing: give it, or a fit or record that determines it");
  Done(command(fit("not_identifiable")) + "--alpha 0.3");
  ExpectRefused(command("x,F\n1,2\n"), "is not the result of a fit");
  ExpectRefused(command("{}"), "is not the result of a fit");
}

TEST_F(Convert, DividesTheSlipForceOfAFitByTheLoadThatItBelongsTo) {
  const auto fit = [&](const std::string& more) {
    return "convert --to lammps " +
           Write("series.json", R"({"schema": "mindahl.fit/2", "model": "mindlin-dahl",
      "input": {"files": ["a", "b"]}, "parameters": {"sigma": {"value": 5e7},
      "alpha": {"value": 0.3}, "slip_force": {"value": 60})" +
                                    more + R"(},
      "contact": {"normal_load": {"value": 150}}, "measured": {"amplitude": 6e-6}})") +
           " ";
  };
  const std::string series = fit(R"(, "load_exponent": {"value": 0.3333})");
  const json made = JsonOf(series);
  EXPECT_DOUBLE_EQ(Value(made, "mu"), Value(made, "slip_force") / 150);
  EXPECT_DOUBLE_EQ(Value(JsonOf(series + "--normal-load 149.9"), "mu"), Value(made, "mu"));
  ExpectRefused(series + "--normal-load 100",
                "--normal-load 100 contradicts the fit, whose slip force is that at 150 N");
  const json given = JsonOf(series + "--normal-load 100 --slip-force 40");
  EXPECT_DOUBLE_EQ(Value(given, "mu"), Value(given, "slip_force") / 100);
  // The amplitude is of one file, the law at the mean load.
  EXPECT_THAT(RunCommand(series).err,
              HasSubstr("of the file nearest to slip, at that file's load"));
  EXPECT_EQ(RunCommand(series + "--amplitude 1e-6").err, "");
  EXPECT_EQ(RunCommand(fit("")).err, "");
}

TEST_F(Convert, SaysWhatOfAFitTheTargetHasNot) {
  const std::string fit = Write("fit.json", R"({"schema": "mindahl.fit/2", "model": "dahl",
      "parameters": {"sigma": {"value": 5e7}, "alpha": {"value": 0.5}, "slip_force": {"value": 30},
      "asymmetry": {"value": -0.2}, "viscous": {"value": 12.5}},
      "terms": {"added": ["rig_stiffness", "asymmetry", "viscous"]},
      "measured": {"amplitude": 2e-6}})");
  EXPECT_EQ(JsonOf("convert --to dahl " + fit)["left_out"], json({"asymmetry", "viscous"}));
  EXPECT_THAT(Done("convert --to dahl --input-lines - " + fit + " --json " + Path("c.json")).out +
                  Done("convert --to dahl " + fit).out,
              HasSubstr("of the law alone: without the fit's asymmetry, viscous\n"));
}

TEST_F(Convert, TakesTheForceOfADragOffTheLawOfAFit) {
  const std::string fit = Write("fit.json", R"({"schema": "mindahl.fit/2", "model": "dahl",
      "parameters": {"sigma": {"value": 5e7}, "alpha": {"value": 0.5}, "slip_force": {"value": 40},
      "drag_fraction": {"value": 0.25}}, "measured": {"amplitude": 2e-6}})");
  const json made = JsonOf("convert --to dahl " + fit);
  EXPECT_EQ(made["from"]["sigma"], 3.75e7);
  EXPECT_EQ(made["from"]["alpha"], 0.5);
  EXPECT_EQ(made["from"]["slip_force"], 30.0);
  const json given = JsonOf("convert --to dahl --slip-force 40 " + fit);
  EXPECT_EQ(given["from"]["slip_force"], 40.0);
}

TEST_F(Convert, OfAContactThatSticksHasNoRelativeErrorOfTheEnergy) {
  // Half of what Jenkins' element slips at.
  const std::string text =
      Done("convert --alpha 0 --amplitude 5e-7 --to lugre" + kMindlinOptions).out;
  EXPECT_THAT(text, HasSubstr("the energy lost where the contact loses none\n"));
  EXPECT_THAT(text, Not(HasSubstr("inf")));
}

TEST_F(Convert, IsOfTheLawThatItIsFrom) {
  for (const std::string from : {"masing", "dahl"}) {
    for (const std::string to : {"masing", "dahl"}) {
      const json made = JsonOf(Command("--alpha 0.5 --from " + from + " --to " + to));
      EXPECT_LT(made["error_at_amplitude"]["force"], 1e-10) << "their steady loops are one curve";
      EXPECT_EQ(Value(made, "sigma") == 4e7 && Value(made, "slip_force") == 40.0, from == to);
    }
  }
}

TEST_F(Convert, RefusesWhatItsTargetHasNot) {
  for (const convert::TargetRow& row : convert::Targets()) {
    const std::string to(row.name);
    const auto refusal = [&](const std::string& more) {
      return RunCommand(Command("--to " + to + more)).err;
    };
    EXPECT_EQ(refusal(" --normal-load 10").empty(), to == "lammps") << to;
    EXPECT_EQ(refusal(""), "") << to;
  }
}

}  // namespace
}  // namespace mindahl::cli::convert_command_test
