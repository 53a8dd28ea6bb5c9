#include "cli/command_line.h"

// fit: the JSON that scripts rely on, files in every unit and format, outputs, exit status.
namespace mindahl::cli::fit_command_test {
namespace {

using FitCommand = CommandTest;

std::string WhyNull(const json& fit, const std::string& path) {
  for (const json& null : fit.at("nulls")) {
    if (null.at("path") == path) return null.at("why");
  }
  return "";
}

TEST_F(FitCommand, OfALoopThatDoesNotSlipExitsWithThreeWhereStrictAndKnowsNoFriction) {
  const std::string fit = "fit " + Simulated("--lambda 0.15 --noise-force 0.05") + " ";
  const Outcome lenient = Done(fit + "--normal-load 80");
  EXPECT_THAT(lenient.err, IsEmpty());
  EXPECT_THAT(lenient.out, AllOf(HasSubstr("does not level off"), HasSubstr("μ > ")));
  const json loaded = JsonOf(fit + "--normal-load 80");
  EXPECT_TRUE(loaded["contact"]["friction_coefficient"]["value"].is_null());
  EXPECT_THAT(WhyNull(loaded, "contact.friction_coefficient.value"),
              HasSubstr("a parameter that is open"));
  const Outcome strict = RunCommand(fit + "--strict");
  EXPECT_EQ(strict.status, kNotEstablished);
  EXPECT_THAT(strict.err, HasSubstr("not established: alpha is not identifiable"));
  Done("fit " + SampleRecord() + " --strict");
}

TEST(FitJson, SaysWhyANumberIsNull) {
  const json fit = JsonOf("fit " + SampleRecord() + " --model mindlin");
  EXPECT_THAT(WhyNull(fit, "contact.friction_coefficient.value"), StartsWith("it needs what is"));
  EXPECT_THAT(WhyNull(fit, "parameters.alpha.ci95[1]"), StartsWith("it is held"));
  EXPECT_THAT(WhyNull(fit, "mapping.p_value"), StartsWith("alpha is held"));
}

TEST(FitJson, OfAFitThatFailedIsWrittenWithStatusThree) {
  const Outcome outcome = RunCommand("fit " + SampleRecord() + " --force-sign opposite --json -");
  EXPECT_EQ(outcome.status, kNotEstablished);
  EXPECT_THAT(outcome.err, HasSubstr("the fit failed"));
  EXPECT_EQ(outcome.Json()["solver"]["converged"], false);
  EXPECT_TRUE(outcome.Json()["parameters"]["sigma"]["value"].is_null());
  EXPECT_THAT(WhyNull(outcome.Json(), "residuals.rms"), StartsWith("the fit failed: "));
  EXPECT_THAT(WhyNull(outcome.Json(), "solver.final_cost"), StartsWith("the fit failed: "));
}

TEST(FitJson, KnowsAsMuchOfAParameterWhateverTheConfidence) {
  const std::string fit = "fit " MINDAHL_SOURCE_DIR "/data/behind_a_rig.csv --confidence ";
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    const json known = JsonOf(fit + "0.95")["parameters"][name]["identifiability"];
    EXPECT_EQ(JsonOf(fit + "0.5")["parameters"][name]["identifiability"], known) << name;
  }
}

TEST(FitJson, SaysWhetherTermsWereChosenAndWhichAreHeld) {
  const json chosen = JsonOf("fit " + SampleRecord() + " --terms auto");
  EXPECT_EQ(chosen["terms"]["mode"], "auto") << "of a record that requires none";
  const json held = JsonOf("fit " + SampleRecord() + " --covariate 1=0");
  EXPECT_EQ(held["terms"]["mode"], "named");
  EXPECT_EQ(held["terms"]["added"], json({"covariate_1"}));
}

TEST_F(FitCommand, ListsTheLinesThatAreLeftOut) {
  std::vector<std::string> lines = Lines(FileContent(SampleRecord()));
  lines.at(200) = "0.5,,";
  const std::string file = Write("gap.csv", fmt::format("{}\n", fmt::join(lines, "\n")));
  const json fit = JsonOf("fit " + file + " --select samples=101:601");
  const json& left_out = fit["input"]["left_out"];
  ASSERT_EQ(left_out.size(), 2U);
  EXPECT_EQ(left_out[0]["why"], "selection");
  EXPECT_EQ(left_out[0]["first"], 2);
  EXPECT_EQ(left_out[0]["last"], 101);
  EXPECT_EQ(left_out[1]["why"], "not whole");
  EXPECT_EQ(left_out[1]["samples"], 1);
}

TEST_F(FitCommand, NotesTimesAndLoadsThatItDoesNotTakeFromTheFile) {
  // On stderr a note is one line, whatever the length of the file's path.
  const auto notes = [](const std::string& fit) { return Done(fit + " --json -").err; };
  EXPECT_THAT(notes("fit " + SampleRecord() + " --sample-rate 1000"),
              HasSubstr("the times are those of --sample-rate, not of 'time [s]' (column 1)"));
  std::string loaded;
  for (const std::string& line : Lines(FileContent(SampleRecord()))) {
    loaded += line + (loaded.empty() ? ",normal load [N]\n" : ",50\n");
  }
  const std::string fit = "fit " + Write("loaded.csv", loaded) + " --normal-load ";
  EXPECT_THAT(notes(fit + "60"), HasSubstr("the mean load is 60 N as given, not 50 N"));
  EXPECT_THAT(notes(fit + "50"), Not(HasSubstr("as given")));
}

TEST_F(FitCommand, WritesItsJsonAloneToStdoutAndTheSameToAFileInEveryDigit) {
  const std::string fit = "fit " + SampleRecord() + " --json ";
  const Outcome to_stdout = Done(fit + "-");
  EXPECT_THAT(Done(fit + Path("fit.json")).out, HasSubstr("stiffness     σ "));
  EXPECT_EQ(to_stdout.out, FileContent(Path("fit.json")));
  EXPECT_EQ(to_stdout.out.front(), '{');
  // 17 significant digits or the shortest that reads back: fewer than 12 would be a rounded copy.
  const std::string sigma = to_stdout.Json()["parameters"]["sigma"]["value"].dump();
  EXPECT_GE(std::ranges::count_if(sigma, [](char c) { return c >= '0' && c <= '9'; }), 12);
  EXPECT_THAT(to_stdout.out, HasSubstr(sigma));
}

TEST_F(FitCommand, OfAFileNameThatIsNoUtf8StillGivesValidJson) {
  EXPECT_TRUE(json::accept(Done({"fit", Copy("caf\xe9.csv"), "--json", "-"}).out));
}

TEST_F(FitCommand, RecoversTheContactOfALoopInTheUnitsAndColumnsOfTheOptions) {
  const std::string loop = Simulated("--lambda 1.3 --cycles 2");
  constexpr double kRoundTrip = 1e-8;  // the promise of a fit without noise
  ExpectMindlin(JsonOf("fit " + loop), kRoundTrip);
  std::string text;
  for (const auto& row : testing::Numbers(FileContent(loop))) {
    text += fmt::format("1\t{}\t{}\n", row[2] / 4.4482216152605, row[1] / 0.0254);
  }
  ExpectMindlin(
      JsonOf({"fit", Write("loop.txt", text), "--displacement", "3 [in]", "--force", "2 [lbf]"}),
      kRoundTrip);
}

TEST_F(FitCommand, ListsEverySampleWithMeasuredAndFittedAmongTheResiduals) {
  Done("fit " + SampleRecord() + " --residuals " + Path("residuals.csv"));
  const auto rows = testing::Rows(FileContent(Path("residuals.csv")));
  const auto input = Lines(FileContent(SampleRecord()));
  ASSERT_EQ(rows.size(), input.size());
  EXPECT_THAT(rows[0], ElementsAre("time [s]", "displacement [m]", "force [N]", "fitted_force [N]",
                                   "residual [N]"));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    ASSERT_THAT(rows[i], SizeIs(5));
    EXPECT_EQ(rows[i][0] + "," + rows[i][1] + "," + rows[i][2], input[i]);
    constexpr double kRounding = 1e-13;  // of forces below 20 N
    EXPECT_NEAR(std::stod(rows[i][3]) - std::stod(rows[i][2]), std::stod(rows[i][4]), kRounding);
  }
}

TEST(FitJson, CountsTheSamplesOfATimeWindow) {
  // 200 samples a second, both ends included.
  EXPECT_EQ(JsonOf("fit " + SampleRecord() + " --time-window 1:2")["input"]["samples"], 201);
}

TEST_F(FitCommand, NumbersTheOffsetsOfTheRecordsOfAJointFit) {
  const json fit = JsonOf("fit " + SampleRecord() + " " + Copy("copy.csv"));
  EXPECT_THAT(fit["input"]["files"], SizeIs(2));
  EXPECT_TRUE(fit["parameters"].contains("force_offset_1"));
  EXPECT_TRUE(fit["parameters"].contains("force_offset_2"));
  EXPECT_FALSE(fit["parameters"].contains("force_offset"));
}

}  // namespace
}  // namespace mindahl::cli::fit_command_test
