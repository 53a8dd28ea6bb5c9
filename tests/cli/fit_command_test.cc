
#include <cstdio>

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

std::string WhyNull(const json& fit, const std::string& path) {
  for (const json& null : fit.at("nulls")) {
    if (null.at("path") == path) return null.at("why");
  }
  return "";
}

TEST(FitCommand, WithholdsTheFrictionCoefficientOfALoopThatDoesNotSlipThoughItsLoadIsKnown) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "partial.csv").string();
  ASSERT_EQ(RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "0.15",
                        "--noise-force", "0.05", "-o", path})
                .status,
            cli::kDone);
  const json fit = FitJson({path, "--normal-load", "80"});
  ASSERT_NE(fit["parameters"]["slip_force"]["identifiability"], "identifiable");
  const json& friction = fit["contact"]["friction_coefficient"];
  EXPECT_TRUE(friction["value"].is_null());
  EXPECT_TRUE(friction["ci95"][1].is_null());
  // μ >= Tc/N with the lower limit of Tc.
  const double least = fit["parameters"]["slip_force"]["ci95"][0].get<double>() / 80;
  EXPECT_NEAR(friction["ci95"][0].get<double>() / least, 1, 1e-12);
  EXPECT_EQ(WhyNull(fit, "contact.friction_coefficient.value"), "needs an identifiable slip_force");
  EXPECT_THAT(RunCommand({"fit", path, "--normal-load", "80"}).out, HasSubstr("μ > "));
}

TEST(FitCommand, NullsNameMissingInputs) {
  const json fit = FitJson({SampleRecord(), "--model", "mindlin"});
  EXPECT_EQ(WhyNull(fit, "contact.friction_coefficient.value"), "needs the normal load");
  EXPECT_EQ(WhyNull(fit, "contact.compliance.value"), "needs the contact radius");
  EXPECT_EQ(WhyNull(fit, "parameters.alpha.ci95[1]"), "it is held");
  EXPECT_THAT(WhyNull(fit, "mapping.p_value"), ::testing::StartsWith("alpha is held"));
  const json failed = FitJson({SampleRecord(), "--force-sign", "opposite"});
  EXPECT_THAT(WhyNull(failed, "residuals.rms"), ::testing::StartsWith("the fit failed: "));
}

TEST(FitCommand, JsonOnStdoutIsAloneAndTheSameAsInAFile) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "fit.json").string();
  const Outcome to_stdout = RunCommand({"fit", SampleRecord(), "--json", "-"});
  const Outcome to_file = RunCommand({"fit", SampleRecord(), "--json", path});
  EXPECT_EQ(to_stdout.status, cli::kDone);
  EXPECT_EQ(to_file.status, cli::kDone);
  EXPECT_EQ(to_stdout.out, FileContent(path));
  EXPECT_THAT(to_file.out, HasSubstr("stiffness     σ "));
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
  ExpectRecovered({directory_.Write("loop.txt", text).string(), "--displacement", "3 [in]",
                   "--force", "2 [lbf]"});
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

TEST(FitCommand, StrictExitsWithThreeWhereAParameterIsNotIdentifiable) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "partial.csv").string();
  ASSERT_EQ(RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "0.15",
                        "--noise-force", "0.1", "-o", path})
                .status,
            cli::kDone);
  const Outcome lenient = RunCommand({"fit", path});
  EXPECT_EQ(lenient.status, cli::kDone);
  EXPECT_EQ(lenient.err, "");
  EXPECT_THAT(lenient.out, HasSubstr("the loop does not come near slip"));
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
