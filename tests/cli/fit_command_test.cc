
#include <cstdio>
#include <regex>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// fit: the JSON that scripts rely on, files in every unit and format, outputs, exit status.
namespace mindahl::cli::fit_command_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

json FitJson(Words words) {
  words.insert(words.begin(), "fit");
  words.insert(words.end(), {"--json", "-"});
  const Outcome outcome = RunCommand(words);
  EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("error")));
  return outcome.Json();
}

bool IsNumberOrNull(const json& value) { return value.is_number() || value.is_null(); }

void ExpectParameter(const json& parameter, const std::string& unit) {
  EXPECT_TRUE(IsNumberOrNull(parameter.at("value")));
  EXPECT_EQ(parameter.at("unit"), unit);
  EXPECT_TRUE(IsNumberOrNull(parameter.at("standard_error")));
  ASSERT_THAT(parameter.at("ci95"), SizeIs(2));
  for (const json& end : parameter.at("ci95")) EXPECT_TRUE(IsNumberOrNull(end));
  const Words statuses = {"free", "fixed", "at_lower_bound", "at_upper_bound"};
  EXPECT_THAT(statuses, ::testing::Contains(parameter.at("status").get<std::string>()));
  const Words verdicts = {"identifiable", "effective", "extrapolated", "bounded_below",
                          "not_identifiable"};
  EXPECT_THAT(verdicts, ::testing::Contains(parameter.at("identifiability").get<std::string>()));
}

/// Every key of docs/contract.md, with its type.
void ExpectContract(const json& fit) {
  EXPECT_EQ(fit.at("schema"), "mindahl.fit/1");
  EXPECT_TRUE(fit.at("version").is_string());
  const json& input = fit.at("input");
  EXPECT_TRUE(input.at("files").is_array());
  for (const char* key : {"samples", "cycles", "reversals"}) {
    EXPECT_TRUE(input.at(key).is_number_unsigned()) << key;
  }
  EXPECT_TRUE(input.at("units").is_object());
  EXPECT_TRUE(fit.at("model").is_string());
  const Words states = {"virgin", "steady"};
  EXPECT_THAT(states, ::testing::Contains(fit.at("initial_state").get<std::string>()));
  ExpectParameter(fit.at("parameters").at("sigma"), "N/m");
  ExpectParameter(fit.at("parameters").at("alpha"), "-");
  ExpectParameter(fit.at("parameters").at("slip_force"), "N");
  EXPECT_TRUE(fit.at("correlation").is_object());
  for (const char* key : {"rms", "max_abs", "normalized_rms", "r_squared", "durbin_watson",
                          "effective_samples", "degrees_of_freedom"}) {
    EXPECT_TRUE(IsNumberOrNull(fit.at("residuals").at(key))) << key;
  }
  const json& solver = fit.at("solver");
  EXPECT_TRUE(solver.at("converged").is_boolean());
  EXPECT_TRUE(solver.at("iterations").is_number_integer());
  EXPECT_TRUE(solver.at("termination").is_string());
  EXPECT_TRUE(solver.at("starts").is_array());
  const json& loop = fit.at("loop");
  for (const char* key :
       {"amplitude", "peak_force", "energy_per_cycle_measured", "energy_per_cycle_model",
        "energy_ratio", "gross_slip_displacement", "stick_radius_ratio"}) {
    EXPECT_TRUE(IsNumberOrNull(loop.at(key))) << key;
  }
  EXPECT_TRUE(loop.at("slip_regime") == "partial" || loop.at("slip_regime") == "gross" ||
              loop.at("slip_regime").is_null());
  for (const char* key : {"friction_coefficient", "contact_radius", "compliance"}) {
    const json& quantity = fit.at("contact").at(key);
    if (quantity.is_null()) continue;
    EXPECT_TRUE(quantity.at("value").is_number()) << key;
    EXPECT_TRUE(IsNumberOrNull(quantity.at("standard_error"))) << key;
  }
  for (const char* key : {"alpha_minus_third", "z", "p_value", "sigma_over_hertz_mindlin"}) {
    EXPECT_TRUE(IsNumberOrNull(fit.at("mapping").at(key))) << key;
  }
  for (const json& warning : fit.at("warnings")) {
    EXPECT_TRUE(warning.at("code").is_string());
    EXPECT_FALSE(warning.at("message").get<std::string>().empty());
  }
}

/// The places of nulls: members by name, places of a list in brackets.
void CollectNulls(const json& value, const std::string& path, Words& nulls) {
  if (value.is_null()) nulls.push_back(path);
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      CollectNulls(member, path.empty() ? key : path + "." + key, nulls);
    }
  }
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      CollectNulls(value[i], path + "[" + std::to_string(i) + "]", nulls);
    }
  }
}

/// `nulls` names every null of the document, each once and with a reason, and nothing else.
void ExpectEveryNullExplained(const json& fit) {
  Words nulls;
  CollectNulls(fit, "", nulls);
  Words named;
  for (const json& null : fit.at("nulls")) {
    named.push_back(null.at("path"));
    EXPECT_FALSE(null.at("why").get<std::string>().empty()) << named.back();
  }
  EXPECT_THAT(named, ::testing::UnorderedElementsAreArray(nulls));
}

std::string WhyNull(const json& fit, const std::string& path) {
  for (const json& null : fit.at("nulls")) {
    if (null.at("path") == path) return null.at("why");
  }
  return "";
}

struct Situation {
  const char* name;
  Words words;
};

class FitJsonOf : public ::testing::TestWithParam<Situation> {
 protected:
  json Run() {
    Words words = GetParam().words;
    for (std::string& word : words) {
      if (word == "@") word = SampleRecord();
      if (word == "copy") word = directory_.Write("copy.csv", FileContent(SampleRecord())).string();
      if (word == "partial") word = Simulated("partial.csv", {"--lambda", "0.15"});
      if (word == "exponential") {
        word = Simulated("exponential.csv",
                         {"--alpha", "1.5", "--amplitude", "3e-6", "--model", "mindlin-dahl"});
      }
      if (word == "slider") {
        word = Simulated("slider.csv", {"--model", "jenkins", "--lambda", "3", "--seed", "2"});
      }
      if (word == "short") {
        word = Simulated("short.csv",
                         {"--lambda", "1.3", "--cycles", "1.25", "--samples-per-cycle", "60"});
      }
      if (word == "quarter") {
        word = Simulated("quarter.csv", {"--lambda", "1.2", "--cycles", "0.25"});
      }
    }
    return FitJson(words);
  }

 private:
  std::string Simulated(const char* file, const Words& options) {
    const std::string path = (directory_.path() / file).string();
    Words words = {"simulate", "--sigma",       "4e7",  "--slip-force", "40", "--cycles",
                   "2.5",      "--noise-force", "0.05", "-o",           path};
    for (std::size_t i = 0; i < options.size(); ++i) {
      if (options[i] == "--cycles") words.erase(words.begin() + 5, words.begin() + 7);
    }
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(RunCommand(words).status, cli::kDone);
    return path;
  }
  TemporaryDirectory directory_;
};

TEST_P(FitJsonOf, HasEveryKeyOfTheContract) { ExpectContract(Run()); }

TEST_P(FitJsonOf, NamesEveryNullOnceAndSaysWhy) { ExpectEveryNullExplained(Run()); }

TEST_P(FitJsonOf, WarnsOfNothingThatOnlyExplainsANull) {
  const json fit = Run();
  for (const json& warning : fit.at("warnings")) {
    const std::string code = warning.at("code");
    for (const char* explanation :
         {"alpha_not_tested", "no_standard_error", "open_interval", "held_fixed", "no_correlation",
          "no_rig_found", "stiffness_not_tested", "compliance_taken_as_known",
          "energy_not_measured", "no_gross_slip", "no_energy_ratio"}) {
      EXPECT_NE(code, explanation);
    }
  }
}

const Words kBodies = {"@",   "--normal-load", "50",   "--youngs-modulus-1", "210e9", "--poisson-1",
                       "0.3", "--radius-1",    "0.02", "--youngs-modulus-2", "210e9", "--poisson-2",
                       "0.3", "--radius-2",    "inf"};

Words Join(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

INSTANTIATE_TEST_SUITE_P(
    FitCommand, FitJsonOf,
    ::testing::Values(
        Situation{"GrossSlip", {"@"}}, Situation{"Mindlin", {"@", "--model", "mindlin"}},
        Situation{"Jenkins", {"@", "--model", "jenkins"}},
        Situation{"Dahl", {"@", "--model", "dahl"}}, Situation{"Partial", {"partial"}},
        Situation{"PartialWithLoad", {"partial", "--normal-load", "80"}},
        Situation{"Exponential", {"exponential"}}, Situation{"AtItsBound", {"slider"}},
        Situation{"MonotoneLoading", {"quarter"}},
        Situation{"Failed", {"@", "--force-sign", "opposite"}},
        Situation{"AllFixed",
                  {"@", "--fix", "sigma=4.8e7", "--fix", "alpha=0.3", "--fix", "slip_force=15"}},
        Situation{"WithLoad", {"@", "--normal-load", "50"}},
        Situation{"WithCompliance", {"@", "--compliance", "4.2e-11"}},
        Situation{"WithRadiusAndCompliance",
                  {"@", "--compliance", "4.2e-11", "--contact-radius", "2.5e-4"}},
        Situation{"WithBodies", kBodies},
        Situation{"WithBodiesPartial",
                  Join({"partial"}, Words(kBodies.begin() + 1, kBodies.end()))},
        Situation{
            "WithExactInputsAlone",
            {"@", "--fix", "sigma=4.8e7", "--contact-radius", "2.5e-4", "--compliance", "4.2e-11"}},
        Situation{"WithRadiusAlone", {"@", "--contact-radius", "2.5e-4"}},
        Situation{"Auto", {"short", "--model", "auto", "--starts", "1"}},
        Situation{"FailedWithBodies", Join(kBodies, {"--force-sign", "opposite"})},
        Situation{"Rig", {"@", "--rig-stiffness", "fit", "--model", "mindlin"}},
        Situation{"Joint", {"@", "copy"}}, Situation{"Steady", {"@", "--initial-state", "steady"}},
        Situation{"Drift", {"@", "--drift"}}, Situation{"NoOffsets", {"@", "--offsets", "off"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(FitCommand, WithholdsTheFrictionCoefficientOfALoopThatDoesNotSlipThoughItsLoadIsKnown) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "partial.csv").string();
  ASSERT_EQ(RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "0.15",
                        "--noise-force", "0.05", "-o", path})
                .status,
            cli::kDone);
  const json fit = FitJson({path, "--normal-load", "80"});
  ASSERT_NE(fit["parameters"]["slip_force"]["identifiability"], "identifiable");
  EXPECT_TRUE(fit["contact"]["friction_coefficient"].is_null());
  // μ >= Tc/N with the lower limit of Tc, printed with three digits.
  const double least = fit["parameters"]["slip_force"]["ci95"][0].get<double>() / 80;
  const std::string why = WhyNull(fit, "contact.friction_coefficient");
  const std::string lead = "needs an identifiable slip force; from this loop it is at least ";
  ASSERT_THAT(why, ::testing::StartsWith(lead));
  EXPECT_NEAR(std::stod(why.substr(lead.size())) / least, 1, 5e-3);
  EXPECT_THAT(RunCommand({"fit", path, "--normal-load", "80"}).out,
              ::testing::Not(HasSubstr("μ = Tc/N")));
}

TEST(FitCommand, NullsNameMissingInputs) {
  const json fit = FitJson({SampleRecord(), "--model", "mindlin"});
  EXPECT_EQ(WhyNull(fit, "contact.friction_coefficient"), "needs the normal load");
  EXPECT_EQ(WhyNull(fit, "contact.compliance"), "needs the contact radius");
  EXPECT_EQ(WhyNull(fit, "parameters.alpha.ci95[1]"), "held, not fitted");
  EXPECT_EQ(WhyNull(fit, "mapping.z"), "alpha was held, so alpha = 1/3 is not tested");
  const json failed = FitJson({SampleRecord(), "--force-sign", "opposite"});
  EXPECT_THAT(WhyNull(failed, "residuals.rms"), ::testing::StartsWith("the fit failed: "));
  EXPECT_EQ(WhyNull(failed, "contact.normal_load"), "not given, and no column has it");
}

TEST(FitCommand, JsonOnStdoutIsAloneAndTheSameAsInAFile) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "fit.json").string();
  const Outcome to_stdout = RunCommand({"fit", SampleRecord(), "--json", "-"});
  const Outcome to_file = RunCommand({"fit", SampleRecord(), "--json", path});
  EXPECT_EQ(to_stdout.status, cli::kDone);
  EXPECT_EQ(to_file.status, cli::kDone);
  EXPECT_EQ(to_stdout.out, FileContent(path));
  EXPECT_THAT(to_file.out, HasSubstr("sigma"));
  EXPECT_EQ(to_stdout.out.front(), '{');
}

TEST(FitCommand, NumbersOfTheJsonReadBackToTheSameDouble) {
  const Outcome outcome = RunCommand({"fit", SampleRecord(), "--json", "-"});
  const json first = outcome.Json();
  EXPECT_EQ(json::parse(first.dump()), first);
  // 17 significant digits or the shortest that reads back: fewer than 12 would be a rounded copy.
  const std::string sigma = first["parameters"]["sigma"]["value"].dump();
  EXPECT_GE(std::ranges::count_if(sigma, [](char c) { return c >= '0' && c <= '9'; }), 12);
  EXPECT_THAT(outcome.out, HasSubstr(sigma));
}

TEST(FitCommand, FileNameThatIsNoUtf8StillGivesValidJson) {
  const TemporaryDirectory directory;
  const std::string path = directory.Write("caf\xe9.csv", FileContent(SampleRecord())).string();
  const Outcome outcome = RunCommand({"fit", path, "--json", "-"});
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  EXPECT_TRUE(json::accept(outcome.out));
}

class SimulatedFile : public ::testing::Test {
 protected:
  // Sample Mindlin contact: δc = 3Tc/(2σ) = 1.5 µm.
  static constexpr double kSigma = 4e7;
  static constexpr double kSlipForce = 40.0;
  // Noise-free promise of the fit; the file holds 17 digits.
  static constexpr double kRoundTrip = 1e-8;

  std::vector<Words> Rows() {
    const Outcome outcome = RunCommand(
        {"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "1.3", "--cycles", "2"});
    EXPECT_EQ(outcome.status, cli::kDone);
    std::vector<Words> rows;
    for (const std::string& line : testing::Lines(outcome.out)) {
      rows.push_back(testing::Cells(line));
    }
    rows.erase(rows.begin());
    return rows;
  }

  void ExpectRecovered(const Words& words) {
    const json fit = FitJson(words);
    EXPECT_NEAR(fit["parameters"]["sigma"]["value"].get<double>() / kSigma, 1, kRoundTrip);
    EXPECT_NEAR(fit["parameters"]["alpha"]["value"].get<double>(), 1.0 / 3, kRoundTrip);
    EXPECT_NEAR(fit["parameters"]["slip_force"]["value"].get<double>() / kSlipForce, 1, kRoundTrip);
  }

  TemporaryDirectory directory_;
};

std::string Digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

TEST_F(SimulatedFile, IsRecoveredAsItIsWritten) {
  const std::string path = (directory_.path() / "loop.csv").string();
  ASSERT_EQ(RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "1.3",
                        "--cycles", "2", "-o", path})
                .status,
            cli::kDone);
  ExpectRecovered({path});
}

TEST_F(SimulatedFile, IsRecoveredFromMicrometresAndMillinewtonsOfTheHeader) {
  std::string text = "Fx (mN),x [um]\n";
  for (const Words& row : Rows()) {
    text += Digits(std::stod(row[2]) * 1e3) + "," + Digits(std::stod(row[1]) * 1e6) + "\n";
  }
  ExpectRecovered({directory_.Write("loop.csv", text).string(), "--force", "1"});
}

TEST_F(SimulatedFile, IsRecoveredFromSemicolonsAndDecimalCommas) {
  std::string text = "Zeit [s];disp_mm;F [kN]\r\n";
  for (const Words& row : Rows()) {
    std::string line = row[0] + ";" + Digits(std::stod(row[1]) * 1e3) + ";" +
                       Digits(std::stod(row[2]) * 1e-3) + "\r\n";
    std::ranges::replace(line, '.', ',');
    text += line;
  }
  ExpectRecovered({directory_.Write("loop.csv", text).string()});
}

TEST_F(SimulatedFile, IsRecoveredWithUnitsAndColumnsFromTheOptions) {
  std::string text;
  for (const Words& row : Rows()) {
    text += "1\t" + Digits(std::stod(row[2]) / 4.4482216152605) + "\t" +
            Digits(std::stod(row[1]) / 0.0254) + "\n";
  }
  ExpectRecovered({directory_.Write("loop.txt", text).string(), "--displacement", "3",
                   "--displacement-unit", "in", "--force", "2", "--force-unit", "lbf"});
}

TEST(FitCommand, ContactComesFromItsDefinitions) {
  const json fit = FitJson({SampleRecord(), "--normal-load", "50", "--compliance", "4.2e-11"});
  const double sigma = fit["parameters"]["sigma"]["value"];
  const double slip_force = fit["parameters"]["slip_force"]["value"];
  constexpr double kRounding = 1e-14;
  EXPECT_NEAR(fit["contact"]["friction_coefficient"]["value"].get<double>() / (slip_force / 50), 1,
              kRounding);
  EXPECT_NEAR(fit["contact"]["contact_radius"]["value"].get<double>() / (sigma * 4.2e-11 / 8), 1,
              kRounding);
  EXPECT_NEAR(fit["mapping"]["alpha_minus_third"].get<double>(),
              fit["parameters"]["alpha"]["value"].get<double>() - 1.0 / 3, kRounding);
}

TEST(FitCommand, ResidualsListEverySampleWithMeasuredAndFitted) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "residuals.csv").string();
  ASSERT_EQ(RunCommand({"fit", SampleRecord(), "--residuals", path}).status, cli::kDone);
  const Words lines = testing::Lines(FileContent(path));
  const Words input = testing::Lines(FileContent(SampleRecord()));
  ASSERT_EQ(lines.size(), input.size());
  EXPECT_EQ(lines[0], "time [s],displacement [m],force [N],fitted_force [N],residual [N]");
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Words cells = testing::Cells(lines[i]);
    ASSERT_THAT(cells, SizeIs(5));
    EXPECT_EQ(cells[0] + "," + cells[1] + "," + cells[2], input[i]);
    constexpr double kRounding = 1e-13;  // of forces below 20 N
    EXPECT_NEAR(std::stod(cells[3]) - std::stod(cells[2]), std::stod(cells[4]), kRounding);
  }
}

TEST(FitCommand, BackboneIsWrittenAsATableAndSaidInWords) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "backbone.csv").string();
  const Outcome outcome = RunCommand({"fit", SampleRecord(), "--backbone", path});
  ASSERT_EQ(outcome.status, cli::kDone);
  EXPECT_THAT(outcome.out, HasSubstr("backbone without a law"));
  const Words lines = testing::Lines(FileContent(path));
  EXPECT_EQ(lines[0], "displacement [m],force [N],lower95 [N],upper95 [N],law [N]");
  // The record is of Mindlin's contact, whose law the backbone finds again within its band of two
  // standard errors; neighbours are off together, and six are by chance once in 10⁸.
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Words cells = testing::Cells(lines[i]);
    ASSERT_THAT(cells, SizeIs(5));
    const double half_band = (std::stod(cells[3]) - std::stod(cells[2])) / 2;
    EXPECT_NEAR(std::stod(cells[1]), std::stod(cells[4]), 3 * half_band);
  }
}

TEST(FitCommand, BackboneIsRefusedOfALawWithoutOne) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "backbone.csv").string();
  const Outcome outcome =
      RunCommand({"fit", SampleRecord(), "--model", "dahl", "--backbone", path});
  EXPECT_EQ(outcome.status, cli::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("--backbone needs a Masing law"));
}

TEST(FitCommand, StrictExitsWithThreeWhereAParameterIsNotIdentifiable) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "partial.csv").string();
  ASSERT_EQ(RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "0.15",
                        "--noise-force", "0.1", "-o", path})
                .status,
            cli::kDone);
  const Outcome lenient = RunCommand({"fit", path});
  EXPECT_EQ(lenient.status, cli::kDone);
  EXPECT_THAT(lenient.err, HasSubstr("warning: slip_force"));
  EXPECT_EQ(RunCommand({"fit", path, "--strict"}).status, cli::kNotEstablished);
  EXPECT_EQ(RunCommand({"fit", SampleRecord(), "--strict"}).status, cli::kDone);
}

TEST(FitCommand, FitThatFailsExitsWithThreeAndStillWritesJson) {
  const Outcome outcome =
      RunCommand({"fit", SampleRecord(), "--force-sign", "opposite", "--json", "-"});
  EXPECT_EQ(outcome.status, cli::kNotEstablished);
  EXPECT_THAT(outcome.err, HasSubstr("the fit failed"));
  EXPECT_EQ(outcome.Json()["solver"]["converged"], false);
  EXPECT_TRUE(outcome.Json()["parameters"]["sigma"]["value"].is_null());
}

TEST(FitCommand, TimeWindowKeepsTheSamplesInIt) {
  const json fit = FitJson({SampleRecord(), "--time-window", "1:2"});
  // 200 samples a second, both ends included.
  EXPECT_EQ(fit["input"]["samples"], 201);
}

TEST(FitCommand, JointFitNumbersTheOffsetsOfItsRecords) {
  const TemporaryDirectory directory;
  const std::string copy = directory.Write("copy.csv", FileContent(SampleRecord())).string();
  const json fit = FitJson({SampleRecord(), copy});
  EXPECT_THAT(fit["input"]["files"], SizeIs(2));
  EXPECT_TRUE(fit["parameters"].contains("force_offset_1"));
  EXPECT_TRUE(fit["parameters"].contains("force_offset_2"));
  EXPECT_FALSE(fit["parameters"].contains("force_offset"));
}

}  // namespace
}  // namespace mindahl::cli::fit_command_test
