#include <sys/resource.h>

#include <cstdlib>
#include <iostream>
#include <ostream>

#include "cli/command_line.h"
#include "cli/standard_input.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// Help, exit status and messages, of good usage and bad.
namespace mindahl::cli::usage_test {
namespace {

using Words = std::vector<std::string>;

TEST(Help, OfEveryCommandExitsWithZeroAndGoesToStdout) {
  for (const char* command : {"fit", "simulate", "validate", "contact", "convert"}) {
    SCOPED_TRACE(command);
    const Outcome outcome = RunCommand({command, "--help"});
    EXPECT_EQ(outcome.status, cli::kDone);
    EXPECT_THAT(outcome.err, IsEmpty());
    EXPECT_THAT(outcome.out, HasSubstr("Usage: mindahl " + std::string(command)));
    EXPECT_THAT(outcome.out, HasSubstr("--config"));
  }
}

TEST(Help, OfCommandsWithPhysicalOptionsStatesTheirUnits) {
  const auto expect_all = [](const char* command, const Words& texts) {
    const std::string help = RunCommand({command, "--help-all"}).out;
    for (const std::string& text : texts) EXPECT_THAT(help, HasSubstr(text)) << command;
  };
  expect_all("fit", {"[N/m]", "[N]", "[m]", "[Pa]", "[1/Pa]", "compliance", "um, nm, in"});
  expect_all("simulate", {"[N/m]", "[N]", "[m]", "[Hz]", "[1/Pa]"});
  expect_all("contact", {"[N]", "[m]", "[Pa]", "[1/Pa]"});
  expect_all("convert", {"[N/m]", "[N]", "[m]", "Examples:"});
  expect_all("validate", {"--cases", "--seed", "--json"});
}

TEST(Help, OfTheProgramListsCommandsAndExitStatus) {
  const Outcome outcome = RunCommand({"--help"});
  EXPECT_EQ(outcome.status, cli::kDone);
  for (const char* text : {"fit", "simulate", "validate", "contact", "Exit status", "[N/m]"}) {
    EXPECT_THAT(outcome.out, HasSubstr(text));
  }
}

TEST(Version, IsPrintedAlone) {
  const Outcome outcome = RunCommand({"--version"});
  EXPECT_EQ(outcome.status, cli::kDone);
  EXPECT_THAT(outcome.out, ::testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

struct BadUsage {
  const char* name;
  Words words;  // "@" is the sample record, "#" a file that must not be written
  const char* message;

  friend void PrintTo(const BadUsage& usage, std::ostream* out) { *out << usage.name; }
};

class BadUsageIsRefused : public ::testing::TestWithParam<BadUsage> {
 protected:
  Outcome Run() {
    Words words = GetParam().words;
    for (std::string& word : words) {
      if (word == "@") word = SampleRecord();
      if (word == "#") word = (directory_.path() / "output").string();
    }
    return RunCommand(words);
  }
  TemporaryDirectory directory_;
};

TEST_P(BadUsageIsRefused, WithStatusTwo) { EXPECT_EQ(Run().status, cli::kBadInput); }

TEST_P(BadUsageIsRefused, WithOneLineOnStderrThatNamesTheFault) {
  const Outcome outcome = Run();
  ASSERT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.Errors().front(), StartsWith("mindahl"));
  EXPECT_THAT(outcome.Errors().front(), HasSubstr(GetParam().message));
}

TEST_P(BadUsageIsRefused, WithNothingWritten) {
  EXPECT_THAT(Run().out, IsEmpty());
  EXPECT_EQ(directory_.FileCount(), 0u);
}

const std::vector<BadUsage> kBadUsage = {
    {"NoCommand", {}, "subcommand is required"},
    {"UnknownCommand", {"solve", "@"}, "there is no command 'solve': must be one of fit, simulate"},
    {"MisspeltCommand",
     {"fitt", "@"},
     "there is no command 'fitt': did you mean 'fit'? must be one of fit, simulate"},
    {"UnknownOption",
     {"fit", "@", "--stiffness", "3"},
     "there is no option '--stiffness': see mindahl fit --help"},
    {"MisspeltOption",
     {"fit", "@", "--dispacement", "3"},
     "there is no option '--dispacement': did you mean '--displacement'? see mindahl fit --help"},
    {"MisspeltOptionWithItsValue",
     {"fit", "@", "--normal_load=50"},
     "there is no option '--normal_load': did you mean '--normal-load'?"},
    {"MisspeltOptionOfEveryCommand",
     {"contact", "--confg", "#"},
     "there is no option '--confg': did you mean '--config'?"},
    {"OptionOfAnotherCommand",
     {"contact", "--waveform", "sine"},
     "there is no option '--waveform': see mindahl contact --help"},
    {"MisspeltOptionOfTheProgram",
     {"--versoin"},
     "there is no option '--versoin': did you mean '--version'? see mindahl --help"},
    {"NoFile", {"fit"}, "required"},
    {"MissingFile", {"fit", "no/such/file.csv", "--json", "#"}, "no/such/file.csv"},
    {"DirectoryForAFile", {"fit", "/", "--json", "#"}, "cannot read '/'"},
    {"UnknownColumn", {"fit", "@", "--force", "load", "--json", "#"}, "no column is called 'load'"},
    {"MisspeltColumn",
     {"fit", "@", "--displacement", "Dispacement", "--json", "#"},
     "no column is called 'Dispacement' (for the displacement): did you mean 'displacement'? the "
     "columns are"},
    {"ColumnZero", {"fit", "@", "--force", "0"}, "there is no column 0"},
    {"UnknownUnit", {"fit", "@", "--force", "[stone]", "--json", "#"}, "'stone'"},
    {"ModelThatNeedsTheAmplitude", {"fit", "@", "--model", "simplified-dahl"}, "--model"},
    {"FixWithoutValue", {"fit", "@", "--fix", "alpha", "--json", "#"}, "--fix: 'alpha'"},
    {"FixWithText", {"fit", "@", "--fix", "alpha=third"}, "'third' is not a number"},
    {"ModelMisspelt",
     {"fit", "@", "--model", "mindin"},
     "--model: 'mindin' is unknown: did you mean 'mindlin'? must be one of auto, mindlin-dahl, "
     "mindlin, jenkins, dahl; see mindahl fit --help"},
    {"TargetMisspelt",
     {"convert", "--sigma", "1e7", "--slip-force", "10", "--amplitude", "1e-6", "--to", "lugree"},
     "--to: 'lugree' is unknown: did you mean 'lugre'?"},
    {"WaveformMisspelt",
     {"simulate", "--sigma", "1e7", "--slip-force", "10", "--lambda", "1", "--waveform",
      "triangel"},
     "--waveform: 'triangel' is unknown: did you mean 'triangle'?"},
    {"FixUnknown", {"fit", "@", "--fix", "beta=1"}, "'beta' is unknown: must be one of sigma"},
    {"FixTwice", {"fit", "@", "--fix", "alpha=1", "--fix", "alpha=2"}, "'alpha' is given twice"},
    {"FixNegativeStiffness", {"fit", "@", "--fix", "sigma=-1"}, "sigma [N/m] = -1 is invalid"},
    {"FixAgainstTheModel", {"fit", "@", "--model", "mindlin", "--fix", "alpha=1"}, "prescribes"},
    {"StartOutsideItsBounds", {"fit", "@", "--start", "alpha=1e6"}, "must lie within its bounds"},
    {"UnitOfALoadThatIsNotThere",
     {"fit", "@", "--normal-load-column", "[kN]"},
     "no column is recognised as the normal load"},
    {"RigSofterThanTheLoop",
     {"fit", "@", "--rig-stiffness", "1e3", "--json", "#"},
     "--rig-stiffness [N/m] = 1000 is invalid: must be >"},
    {"ForceNoiseBeyondSquares",
     {"fit", "@", "--force-noise", "1e160"},
     "must be below 1e100 times"},
    {"GateWiderThanTheMotion",
     {"fit", "@", "--reversal-gate", "1"},
     "--reversal-gate 1: the motion ranges over "},
    {"LoadNotPositive", {"fit", "@", "--normal-load", "0"}, "--normal-load [N] = 0"},
    {"WindowEmpty", {"fit", "@", "--time-window", "50:60"}, "holds no sample"},
    {"PlotOfUnknownKind", {"fit", "@", "--json", "#", "--plot", "loop.txt"}, ".svg or .png"},
    {"JsonInNoDirectory",
     {"fit", "@", "--json", "/no/such/x.json", "--residuals", "#"},
     "there is no directory '/no/such'"},
    {"TableOfAFormatThatIsNotWritten",
     {"track", "@", "--output", "cycles.Parquet", "--json", "#"},
     "--output: 'cycles.Parquet' would hold text, not what .parquet says"},
    {"TableOfAFormatBehindAShortName",
     {"track", "@", "--output", "cycles.pq", "--json", "#"},
     "--output: 'cycles.pq' would hold text, not what .pq says"},
    {"JsonOverADirectory", {"fit", "@", "--json", "/tmp", "--residuals", "#"}, "is a directory"},
    {"ResidualsInNoDirectory",
     {"fit", "@", "--json", "#", "--residuals", "/no/such/r.csv"},
     "--residuals: cannot write"},
    {"ConfigMissing", {"fit", "@", "--config", "no.toml"}, "no.toml"},
    {"SimulateWithoutParameters", {"simulate", "--lambda", "1"}, "--sigma missing"},
    {"SimulateWithoutSlipForce",
     {"simulate", "--sigma", "1", "--lambda", "1"},
     "--slip-force missing"},
    {"SimulateWithoutAmplitude",
     {"simulate", "--sigma", "1", "--slip-force", "1", "-o", "#"},
     "--lambda or --amplitude"},
    {"SimulateWithTwoAmplitudes",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--lambda", "1", "--amplitude", "1"},
     "--lambda or --amplitude"},
    {"SimulateWithTwoContacts",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--amplitude", "1", "--contact-radius", "1"},
     "exclude"},
    {"SimulatePathWithWaveform",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--path", "p.csv", "--waveform", "sine"},
     "excludes --path"},
    {"SimulateLambdaWithoutSlip",
     {"simulate", "--model", "dahl", "--sigma", "1", "--slip-force", "1", "--alpha", "1",
      "--lambda", "1"},
     "give --amplitude"},
    {"SimulateAlphaAgainstTheModel",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--alpha", "1", "--lambda", "1"},
     "contradicts --model mindlin"},
    {"SimulateNegativeNoise",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--lambda", "1", "--noise-force", "-1"},
     "--noise-force [N] = -1"},
    {"SimulateThreeSamples",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--lambda", "1", "--samples-per-cycle", "3"},
     "must be a whole number from 4"},
    {"SimulateToleranceBelowRounding",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--lambda", "1", "--method", "dopri5",
      "--tolerance", "1e-20", "-o", "#"},
     "tolerance [-] = 1e-20 is invalid: must be >= 8.88178e-16"},
    {"SimulateNegativeSeed",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--lambda", "1", "--seed", "-1"},
     "must be a whole number from 0"},
    {"SimulateInNoDirectory",
     {"simulate", "--sigma", "1", "--slip-force", "1", "--lambda", "1", "-o", "/no/such/x.csv"},
     "cannot write"},
    {"SimulateBeyondDoubles",
     {"simulate", "--sigma", "1e300", "--slip-force", "1e-300", "--lambda", "1", "-o", "#"},
     "stiffness over slip force"},
    {"ValidateNoCases", {"validate", "--cases", "0", "--json", "#"}, "whole number from 1"},
    {"ValidateInNoDirectory",
     {"validate", "--cases", "1", "--json", "/no/such/v.json"},
     "there is no directory"},
    {"ConvertWithoutALaw", {"convert", "--amplitude", "1e-6", "--to", "dahl"}, "--sigma"},
    {"ConvertToNoLaw",
     {"convert", "--sigma", "1", "--slip-force", "1", "--amplitude", "1", "--to", "maxwell"},
     "--to"},
    {"ConvertNegativeAmplitude",
     {"convert", "--sigma", "1", "--slip-force", "1", "--amplitude", "-1", "--to", "dahl"},
     "amplitude [m] = -1"},
    {"ConvertToLammpsWithoutALoad",
     {"convert", "--sigma", "1", "--slip-force", "1", "--amplitude", "1", "--to", "lammps",
      "--input-lines", "-"},
     "--normal-load"},
    {"ConvertWithALoadForNothing",
     {"convert", "--sigma", "1", "--slip-force", "1", "--amplitude", "1", "--to", "dahl",
      "--normal-load", "3"},
     "unless --to is one of lammps, liggghts, yade"},
    {"ConvertWithARadiusForNothing",
     {"convert", "--sigma", "1", "--slip-force", "1", "--amplitude", "1", "--to", "yade",
      "--contact-radius", "3"},
     "unless --to is one of lammps"},
    {"ConvertWithDampingForNothing",
     {"convert", "--sigma", "1", "--slip-force", "1", "--amplitude", "1", "--to", "yade",
      "--viscous", "3"},
     "mujoco-joint, urdf, sdf"},
    {"ConvertTwiceToStandardOutput",
     {"convert", "--sigma", "1", "--slip-force", "1", "--amplitude", "1", "--to", "dahl", "--json",
      "-", "--input-lines", "-"},
     "give each a file"},
    {"ConvertToleranceInWords",
     {"convert", "--sigma", "1", "--slip-force", "1", "--amplitude", "1", "--to", "dahl",
      "--tolerance", "little"},
     "--tolerance 'little' is invalid"},
    {"ContactIncomplete", {"contact", "--friction", "0.3", "--json", "#"}, "--normal-load"},
    {"ContactDescribedTwice",
     {"contact", "--friction", "0.3", "--normal-load", "1", "--contact-radius", "1", "--compliance",
      "1", "--radius-1", "1"},
     "give one of the two"},
    {"ContactOfTwoPlanesNamesBothRadii",
     {"contact", "--friction", "0.3", "--normal-load", "1", "--youngs-modulus-1", "1e9",
      "--poisson-1", "0.3", "--radius-1", "inf", "--youngs-modulus-2", "1e9", "--poisson-2", "0.3",
      "--radius-2", "inf"},
     "relative curvature 1/R1 + 1/R2 [1/m]"},
    {"StiffnessIsNamedAsItsOption",
     {"simulate", "--sigma", "nan", "--slip-force", "1", "--lambda", "1"},
     "--sigma [N/m] = nan is invalid: must be finite and > 0"},
    {"TradeoffOfAnExponentAlone",
     {"tradeoff", "--alpha", "0.7", "--json", "#"},
     "--sigma missing: give --sigma and --slip-force"},
    {"ContactBeyondDoubles",
     {"contact", "--friction", "0.3", "--normal-load", "1e300", "--contact-radius", "1e-200",
      "--compliance", "4e-300", "--json", "#"},
     "maximum pressure [Pa] = inf"},
};

INSTANTIATE_TEST_SUITE_P(CommandLine, BadUsageIsRefused, ::testing::ValuesIn(kBadUsage),
                         [](const auto& test) { return std::string(test.param.name); });

struct BadFile {
  const char* name;
  const char* content;
  const char* message;
};

TEST(StandardInput, IsReadUnderADash) {
  const auto without_name = [](const std::string& record) {
    nlohmann::json json = RunCommand({"fit", record, "--json", "-"}).Json();
    json["input"].erase("files");
    return json;
  };
  const nlohmann::json of_file = without_name(SampleRecord());
  const testing::StandardInput input(SampleRecord());
  EXPECT_EQ(without_name("-"), of_file);
  const TemporaryDirectory directory;
  const testing::StandardInput broken(directory.Write("b.csv", "x [m],F [N]\n0,0\n1,one\n"));
  const Outcome refused = RunCommand({"fit", "-"});
  EXPECT_EQ(refused.status, cli::kBadInput);
  EXPECT_THAT(refused.err, HasSubstr("standard input:3:2: 'one' is not a number"));
}

// As `ulimit -v` makes of it: more is asked for than the process may have.
TEST(Limits, MemoryThatRunsOutIsOneOfThem) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer takes terabytes of addresses for itself";
#else
  const auto simulate_in_little_memory = [] {
    constexpr rlim_t kLittle = 1U << 30U;
    const rlimit limit{.rlim_cur = kLittle, .rlim_max = kLittle};
    if (::setrlimit(RLIMIT_AS, &limit) != 0) std::exit(1);
    const Outcome outcome =
        RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "1", "--cycles",
                    "3", "--samples-per-cycle", "300000000"});
    std::cerr << outcome.err;
    std::exit(outcome.status);
  };
  EXPECT_EXIT(simulate_in_little_memory(), ::testing::ExitedWithCode(cli::kBadInput),
              "memory ran out: the process had .* MB and may have 1.07 GB");
#endif
}

TEST(BadFiles, AreRefusedWithOneLineThatNamesTheFault) {
  const std::vector<BadFile> files = {
      {"empty.csv", "", "the file is empty"},
      {"header.csv", "x [m],F [N]\n", "header.csv:1: the file ends after its header"},
      {"one.csv", "x [m],F [N]\n1,2\n", "one.csv:2:1: the displacement never changes"},
      {"still.csv", "#\nx [m],F [N]\n1,2\n1,3\n1,4\n", "still.csv:3:1: the displacement never"},
      {"mm.csv", "t [s],F [N],x [mm]\n1,2,5\n2,3,5\n",
       "mm.csv:2:3: the displacement never changes, it is 0.005 m in every row"},
      {"slack.csv", "x [m],F [N]\n1,2\n2,2\n1,2\n", "slack.csv:2:2: the force never changes"},
      {"two.csv", "x [m],F [N]\n0,0\n1,1\n", "two.csv: 2 samples are too few for"},
      {"few.csv", "x [m],F [N]\n0,0\n1,1\n0,-1\n1,1\n",
       "few.csv: 4 samples are too few for 5 free parameters"},
      {"bar.csv", "x [m],F [bar]\n0,0\n1,1\n0,-1\n",
       "bar.csv:1:2: 'F [bar]' (column 2) is a pressure, in bar, and no force"},
      {"words.csv", "x [m],F [N]\n0,a\n1,b\n0,c\n",
       "words.csv: 'F [N]' (column 2) holds no numbers"},
      {"allwords.csv", "x,F\na,b\nc,d\n", "allwords.csv:3:1: 'c' is not a number"},
      {"nans.csv", "x [m],F [N]\nnan,nan\nnan,nan\n", "nans.csv:2:1: 'nan' is not a number"},
      {"na.csv", "x [m],F [N]\n0,0\n#N/A,1\n0,2\n1,1\n", "na.csv:3:1: '#N/A' is not a number"},
      {"clock.csv", "0,0,0\n1,1,5\n2,0,-5\n3,-1,0\n",
       "clock.csv: 4 samples are too few for 5 free parameters"},
      {"speed.csv", "speed,F [N]\n0,0\n1,1\n0,-1\n",
       "speed.csv: no column for the displacement: the columns are 'speed' (1), 'F [N]' (2)"},
      {"unfit.csv", "angle [deg],F [N]\n0,0\n1,1\n0,-1\n", "do not match"},
      {"nan.csv", "x [m],F [N]\n0,0\n1,nan\n2,1\n", "nan.csv:3:2: 'nan' is not a number"},
      {"text.csv", "x [m],F [N]\n0,0\n1,one\n2,1\n", "text.csv:3:2"},
      {"huge.csv", "x [m],F [N]\n0,0\n1e300,1\n-1e300,-1\n",
       "half range of the displacement [m] = 1e+300 is invalid: must lie between"},
      {"tiny.csv", "x [m],F [N]\n0,0\n1,1e-300\n-1,-1e-300\n0,0\n", "choose other units"}};
  for (const BadFile& file : files) {
    SCOPED_TRACE(file.name);
    const TemporaryDirectory directory;
    const std::string path = directory.Write(file.name, file.content).string();
    const Outcome outcome =
        RunCommand({"fit", path, "--json", (directory.path() / "out.json").string()});
    EXPECT_EQ(outcome.status, cli::kBadInput);
    EXPECT_THAT(outcome.out, IsEmpty());
    ASSERT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.Errors().front(), HasSubstr(file.message));
    EXPECT_EQ(directory.FileCount(), 1u) << "an output was left behind";
  }
}

class Config : public ::testing::Test {
 protected:
  Outcome FitWith(const std::string& toml, const Words& more = {}) {
    const std::string path = directory_.Write("options.toml", toml).string();
    Words words = {"fit", SampleRecord(), "--json", "-", "--config", path};
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words);
  }
  TemporaryDirectory directory_;
};

TEST_F(Config, GivesOptionsWithAndWithoutTheCommandsSection) {
  for (const char* toml :
       {"model = \"mindlin\"\nnormal-load = 50\n", "[fit]\nmodel = \"mindlin\"\nnormal-load = 50\n",
        "[simulate]\nsigma = 1\n[fit]\nmodel = \"mindlin\"\nnormal-load = 50\n"}) {
    SCOPED_TRACE(toml);
    const Outcome outcome = FitWith(toml);
    ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
    EXPECT_EQ(outcome.Json()["model"], "mindlin");
    EXPECT_EQ(outcome.Json()["contact"]["normal_load"]["value"], 50.0);
  }
}

TEST_F(Config, TakesListsAndYieldsToTheCommandLine) {
  const Outcome outcome =
      FitWith("fix = [\"alpha=0.3\", \"force_offset=0\"]\nmodel = \"jenkins\"\n",
              {"--model", "mindlin-dahl"});
  ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
  const nlohmann::json json = outcome.Json();
  EXPECT_EQ(json["model"], "mindlin-dahl");
  EXPECT_EQ(json["parameters"]["alpha"]["value"], 0.3);
  EXPECT_EQ(json["parameters"]["alpha"]["status"], "fixed");
  EXPECT_EQ(json["parameters"]["force_offset"]["status"], "fixed");
}

TEST_F(Config, RefusesWhatItDoesNotKnow) {
  struct Case {
    const char* toml;
    const char* message;
  };
  for (const Case& c :
       {Case{"modle = \"mindlin\"\n", "'fit.modle' is no option of fit"},
        Case{"[fit]\nmodle = 1\n", "options.toml:2: 'fit.modle' is no option of fit"},
        Case{"[fit.model]\nname = 1\n", "options.toml:1: the value is no string"},
        Case{"model = \"dahl\"\nb = 3:5\n", "options.toml:2: "},
        Case{"model = \"dahl\"\n\nmodel = \"mindlin\"\n", "options.toml:3: "},
        Case{"model = \"open\n", "options.toml:1: "},
        Case{"fix = [1, [2]]\n", "options.toml:1: the value is no string"},
        Case{"model = 2026-01-01\n", "options.toml:1: the value is no string"},
        Case{"[fits]\nmodel = \"mindlin\"\n", "'fit.fits' is no option of fit"},
        Case{"model = \"coulomb\"\n", "--model"},
        Case{"normal-load = \"heavy\"\n", "--normal-load"}}) {
    SCOPED_TRACE(c.toml);
    const Outcome outcome = FitWith(c.toml);
    EXPECT_EQ(outcome.status, cli::kBadInput);
    EXPECT_THAT(outcome.out, IsEmpty());
    ASSERT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.Errors().front(), HasSubstr(c.message));
  }
}

}  // namespace
}  // namespace mindahl::cli::usage_test
