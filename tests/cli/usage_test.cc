#include <sys/resource.h>

#include <cstdlib>
#include <iostream>
#include <regex>

#include "cli/command_line.h"
#include "cli/standard_input.h"

// Help, exit status and messages, of good usage and bad.
namespace mindahl::cli::usage_test {
namespace {

TEST(Help, OfEveryCommandExitsWithZeroAndGoesToStdout) {
  EXPECT_THAT(Done("--help").out, HasSubstr("Exit status"));
  for (const std::string command : {"fit", "simulate", "validate", "contact", "convert", "plan",
                                    "tradeoff", "track", "batch"}) {
    const Outcome outcome = Done(command + " --help");
    EXPECT_THAT(outcome.err, IsEmpty());
    EXPECT_THAT(outcome.out, HasSubstr("Usage: mindahl " + command));
    EXPECT_THAT(outcome.out, HasSubstr("--config"));
  }
}

TEST(Version, IsPrintedAlone) {
  EXPECT_THAT(Done("--version").out, ::testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

struct BadUsage {
  /// @ is the sample record, & one under 100 N, % one of a single stroke, # a file that must not be
  /// written, and ~ a law.
  std::string line;
  std::string message;
};

const std::vector<BadUsage> kBadUsage = {
    {"", "subcommand is required"},
    {"fitt @", "command 'fitt' is unknown: must be one of fit, simulate, validate, contact,"},
    {"fit @ --stiffness 3", "not expected: --stiffness"},
    {"fit @ --dispacement 3", "not expected: --dispacement"},
    {"contact --waveform sine", "not expected: sine --waveform"},
    // Records and their columns
    {"fit", "required"},
    {"fit no/such/file.csv --json #", "no/such/file.csv"},
    {"fit / --json #", "cannot read '/'"},
    {"fit @ --displacement Dispacement --json #",
     "no column is called 'Dispacement' (for the displacement): the "
     "columns are"},
    {"fit @ --normal-load-column [kN]", "no column for the normal load"},
    {"fit & --covariate normal=",
     "--covariate: 'normal=' is invalid: write COL[=C|fit], e.g. pressure=50"},
    {"fit & --covariate normal=much",
     "--covariate: 'normal=much' is invalid: write COL[=C|fit], e.g. pressure=50"},
    {"fit & --covariate normal --covariate normal=3",
     "is used already: choose another column for the covariate"},
    {"fit & --covariate pressure",
     "no column is called 'pressure' (for the covariate): the columns are"},
    // The model
    {"fit @ --model simplified-dahl", "--model"},
    {"fit @ --model mindin",
     "--model: mindin not in {auto,mindlin-dahl,mindlin,jenkins,dahl}; see mindahl fit --help"},
    {"fit @ --loss l1", "--loss: l1 not in {none,huber,cauchy,tukey}; see mindahl fit --help"},
    {"fit @ --fix alpha --json #", "--fix: 'alpha'"},
    {"fit @ --fix alpha=third", "--fix: 'alpha=third' is invalid: write NAME=VALUE"},
    {"fit @ --fix beta=1", "--fix: parameter 'beta' is unknown: must be one of sigma"},
    {"fit @ --fix alpha=1 --fix alpha=2", "'alpha' is given twice"},
    {"fit @ --fix sigma=-1", "sigma [N/m] = -1 is invalid"},
    {"fit @ --model mindlin --fix alpha=1", "prescribes"},
    {"fit @ --model mindlin --start alpha=0.3", "--start: alpha is not fitted"},
    {"fit @ --start alpha=1e6", "must lie within its bounds"},
    {"fit @ --bound plateau_slope=0:1",
     "--bound: plateau_slope is not fitted, so this has no effect: leave it out, or add --terms"},
    {"fit @ --fix load_exponent=0.5", "load_exponent has no effect"},
    {"fit @ --start load_exponent=0.5", "load_exponent has no effect"},
    {"fit @ --bound load_exponent=0:1", "load_exponent has no effect"},
    {"fit @ --terms pressure",
     "no column is called 'pressure' (for the covariate): the columns are"},
    {"fit @ --fix lag=1e6", "move every sample of a record of"},
    {"fit @ --fix backlash=1", "must be below the range of the displacement"},
    {"fit @ --fix force_offset=1e300", "must be within a factor of 1e100 of what the records show"},
    {"fit @ --prior sigma=5e7+-1e-300", "must be within a factor of 1e100"},
    {"fit @ --bound drag_fraction=0:0.5", "drag_fraction is not fitted"},
    {"fit @ --fix asymmetry=1", "asymmetry [-] = 1 is invalid: must be in (-1, 1)"},
    {"fit @ --terms asymmetry --model dahl --rig-stiffness fit",
     "asymmetry and rig_stiffness of dahl"},
    {"fit @ --terms asymmetry --initial-state steady",
     "asymmetry cannot be distinguished from force_offset: the contact had slipped before the "
     "fitted samples"},
    {"fit @ --rig-stiffness soft", "--rig-stiffness: 'soft' is not a number"},
    {"fit @ --rig-stiffness 0", "--rig-stiffness [N/m] = 0 is invalid: must be finite and > 0"},
    {"fit @ --rig-stiffness 1e3 --json #", "--rig-stiffness [N/m] = 1000 is invalid: must be >"},
    {"fit @ --force-noise 1e160", "must be below 1e100 times"},
    {"fit @ --displacement-noise -1e-9",
     "--displacement-noise [m] = -1e-09 is invalid: must be finite and >= 0"},
    {"fit @ --normal-load 0", "--normal-load [N] = 0"},
    {"fit @ --normal-load 25,", "--normal-load: ''"},
    // The selection of samples
    {"fit @ --time-window 50:60", "no sample lies in the window"},
    {"fit @ --select load",
     "--select: 'load' is invalid: write cycles=LO:HI or samples=LO:HI, counted from 1, time="},
    {"fit @ --select cycle=1:2", "--select: 'cycle=1:2' is invalid"},
    {"fit @ --terms viscous,auto", "--terms: auto stands alone"},
    {"fit @ --terms foo", "--terms: 'foo' is no term, so it is taken for a column"},
    {"fit @ --select load=5", "--select: 'load=5' is invalid"},
    {"fit @ --select load=1:2",
     "--select load=LO:HI needs a normal load in every record: name its column with "
     "--normal-load-column"},
    {"fit @ --load-window 5:4", "--load-window: 'load=5:4' is invalid"},
    {"fit & --select load=5:6", "nothing is left of record 1"},
    {"fit @ --select cycles=40:50", "cycles 40:50 contain nothing of record 1, which has"},
    {"fit @ --cycles 0:2",
     "--cycles: 'cycles=0:2' is invalid: write cycles=LO:HI or samples=LO:HI, counted from 1"},
    {"fit @ --select samples=5:4",
     "--select samples: '5:4' is empty: the first number must not be the larger"},
    {"fit @ --samples 100000:200000",
     "samples 100000:200000 contain nothing of record 1, which has"},
    // The outputs
    {"fit @ --json # --plot loop.txt", ".svg or .png"},
    {"fit @ --json /no/such/x.json --residuals #", "there is no directory '/no/such'"},
    {"fit @ --json /tmp --residuals #", "is a directory"},
    {"fit @ --json # --residuals /no/such/r.csv", "--residuals: cannot write"},
    {"fit @ --config no.toml", "no.toml"},
    {"track @ --output /dev/null", "cannot write '/dev/null'"},
    {"track @ --output # --compare", "--compare"},
    {"track @ --output # --fix foo=1", "parameter 'foo' is unknown: must be one of sigma"},
    {"track @ --output # --covariate 1", "--covariate"},
    {"track @ --output # --terms asymmetry", "--terms asymmetry is not available in track"},
    {"track & --output # --terms normal",
     "--terms: 'normal' is no term: that of a column is not available in track"},
    {"track @ --output # --fix sigma=-1", "fixed sigma [N/m] = -1 is invalid: must be finite and"},
    {"track @ --output # --fix rig_stiffness=1e3", "must be > "},
    {"track @ --output # --fix load_exponent=0.3", "load_exponent has no effect"},
    {"track @ --output # --resume --overwrite", "--resume excludes --overwrite"},
    {"track % --output #", "no whole cycle: it lasts from one turning point to the next but one"},
    {"track % --output #", "use mindahl fit for a single cycle"},
    {"track nowhere.csv --output #", "nowhere.csv"},
    {"batch @ --output # --fix alpha=x", "'alpha=x' is invalid"},
    {"batch @ --output # --report /no/such/pages", "--report: "},
    {"batch @ --output # --report @", "--report: "},
    {"batch @ --output # --report #", "is another output too"},
    // simulate
    {"simulate --lambda 1", "--sigma missing"},
    {"simulate --sigma 1 --lambda 1", "--slip-force missing"},
    {"simulate ~ -o #", "--lambda or --amplitude"},
    {"simulate ~ --lambda 1 --amplitude 1", "--lambda or --amplitude"},
    {"simulate ~ --amplitude 1 --contact-radius 1", "exclude"},
    {"simulate ~ --path p.csv --waveform sine", "excludes --path"},
    {"simulate ~ --lambda 1 --waveform triangel", "--waveform: triangel not in {sine,"},
    {"simulate --model dahl ~ --alpha 1 --lambda 1",
     "--lambda: a law of alpha = 1 has no gross-slip displacement: give --amplitude"},
    {"simulate ~ --alpha 1 --lambda 1", "contradicts --model mindlin"},
    {"simulate --sigma nan --slip-force 1 --lambda 1",
     "--sigma [N/m] = nan is invalid: must be finite and > 0"},
    {"simulate --sigma 2±1 --slip-force 3 --lambda 1", "--sigma"},
    {"simulate ~ --lambda 1 --growth 2",
     "--growth has no effect unless --waveform is growing-sine"},
    {"simulate ~ --lambda 1 --noise-force -1", "--noise-force [N] = -1"},
    {"simulate ~ --lambda 1 --samples-per-cycle 3", "--samples-per-cycle: Value 3 not in range"},
    {"simulate ~ --lambda 1 --seed -1", "--seed: Value -1 not in range"},
    {"simulate ~ --lambda 1 -o /no/such/x.csv", "cannot write"},
    {"simulate --sigma 1e300 --slip-force 1e-300 --lambda 1 -o #", "stiffness over slip force"},
    {"simulate ~ --amplitude 1 --method dopri5 --steps 0", "--steps: Value 0 not in range"},
    {"simulate ~ --amplitude 1 --method iwan --model dahl", "cannot compute model dahl"},
    // The other commands
    {"validate --cases 0 --json #", "--cases: Value 0 not in range"},
    {"validate --cases 1 --json /no/such/v.json", "there is no directory"},
    {"convert --amplitude 1e-6 --to dahl", "--sigma"},
    {"convert --to dahl", "--sigma missing: give it, or a fit or record"},
    {"convert ~ --amplitude 1 --to lugree", "--to: lugree not in {masing,"},
    {"convert ~ --amplitude -1 --to dahl", "amplitude [m] = -1"},
    {"convert ~ --amplitude 1 --to lammps --input-lines -", "--normal-load"},
    {"convert ~ --amplitude 1 --to dahl --normal-load 3", "unless --to is lammps"},
    {"convert ~ --amplitude 1 --to dahl --elements 3", "unless --to is iwan"},
    {"convert ~ --amplitude 1 --to dahl --json - --input-lines -", "give each a file"},
    {"convert ~ --amplitude 1 --to dahl --tolerance little",
     "--tolerance: 'little' is no quantity in -"},
    {"contact --friction 0.3 --json #", "--normal-load"},
    {"contact --friction 0.3 --normal-load 1 --youngs-modulus-1 1e9 --poisson-1 0.3 "
     "--radius-1 inf --youngs-modulus-2 1e9 --poisson-2 0.3 --radius-2 inf",
     "relative curvature 1/R1 + 1/R2 [1/m]"},
    {"contact --friction 0.3 --normal-load 1e300 --contact-radius 1e-200 --compliance 4e-300 "
     "--json #",
     "maximum pressure [Pa] = inf"},
    {"tradeoff --alpha 0.7 --json #", "--sigma missing: give --sigma and --slip-force"},
    {"tradeoff --tolerance -1%", "--tolerance"},
    {"tradeoff --tolerance 200%", "--tolerance"},
    {"plan ~", "--force-noise missing: give"},
    {"plan ~ --force-noise 0.4 --want alpha", "'alpha' is no precision"},
    {"plan ~ --force-noise 0.4 --want alpha=1x", "--want: 'alpha=1x' is no precision"},
    {"plan ~ --force-noise 0.4 --want alpha=0", "is no precision"},
    {"plan ~ --force-noise 0.4 --want beta=1", "'beta' is unknown"},
    {"plan ~ --record loop.csv", "--record excludes --sigma"},
    {"plan ~ --displacement 1", "--displacement requires --record"},
    {"plan ~ --force [kN]", "--force requires --record"},
    {"plan ~ --time 1", "--time requires --record"},
    {"plan ~ --normal-load-column 1", "--normal-load-column requires --record"},
    {"plan ~ --sample-rate 100", "--sample-rate requires --record"},
    {"plan ~ --encoding latin1", "--encoding requires --record"},
};

TEST(BadUsage, IsRefusedInOneLineThatNamesTheFault) {
  for (const BadUsage& usage : kBadUsage) {
    const TemporaryDirectory records;
    std::string loaded;
    for (const std::string& line : Lines(FileContent(SampleRecord()))) {
      loaded += line + (loaded.empty() ? ",normal [N]\n" : ",100\n");
    }
    const TemporaryDirectory directory;
    Words words = std::regex_replace(usage.line, std::regex("~"), "--sigma 1 --slip-force 1");
    for (std::string& word : words) {
      if (word == "@") word = SampleRecord();
      if (word == "&") word = records.Write("loaded.csv", loaded);
      if (word == "%") word = records.Write("stroke.csv", "x,F\n0,0\n1,1\n2,2\n3,2.5\n4,2.7\n");
      if (word == "#") word = directory.path() / "output";
    }
    ExpectRefused(words, usage.message);
    EXPECT_EQ(directory.FileCount(), 0u) << usage.line;
  }
}

TEST(StandardInput, IsReadUnderADash) {
  const auto without_name = [](const std::string& record) {
    json fit = JsonOf("fit " + record);
    fit["input"].erase("files");
    return fit;
  };
  const json of_file = without_name(SampleRecord());
  const testing::StandardInput input(SampleRecord());
  EXPECT_EQ(without_name("-"), of_file);
  const TemporaryDirectory directory;
  const testing::StandardInput broken(directory.Write("b.csv", "x [m],F [N]\n0,0\n1,one\n"));
  ExpectRefused("fit -", "standard input:3:2: 'one' is not a number");
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
    const Outcome outcome = RunCommand("simulate" + kMindlinOptions +
                                       "--lambda 1 --cycles 3 --samples-per-cycle 300000000");
    std::cerr << outcome.err;
    std::exit(outcome.status);
  };
  EXPECT_EXIT(simulate_in_little_memory(), ::testing::ExitedWithCode(kBadInput),
              "memory ran out: ask for less, or allow more");
#endif
}

struct BadFile {
  std::string name;
  std::string content;
  std::string message;
};

TEST(BadFiles, AreRefusedWithOneLineThatNamesTheFault) {
  const std::vector<BadFile> files = {
      {"empty.csv", "", "the file is empty"},
      {"header.csv", "x [m],F [N]\n", "header.csv:1: no row down to 'x [m],F [N]' has numbers"},
      {"one.csv", "x [m],F [N]\n1,2\n", "one.csv:2:1: the displacement never changes"},
      {"still.csv", "#\nx [m],F [N]\n1,2\n1,3\n1,4\n", "still.csv:3:1: the displacement never"},
      {"mm.csv", "t [s],F [N],x [mm]\n1,2,5\n2,3,5\n",
       "mm.csv:2:3: the displacement never changes, it is 0.005 m in every row"},
      {"slack.csv", "x [m],F [N]\n1,2\n2,2\n1,2\n", "slack.csv:2:2: the force never changes"},
      {"two.csv", "x [m],F [N]\n0,0\n1,1\n", "2 samples are too few for"},
      {"few.csv", "x [m],F [N]\n0,0\n1,1\n0,-1\n1,1\n",
       "4 samples are too few for 5 free parameters"},
      {"bar.csv", "x [m],F [bar]\n0,0\n1,1\n0,-1\n",
       "bar.csv:1:2: the unit 'bar' of 'F [bar]' (column 2) is not known for the force"},
      {"words.csv", "x [m],F [N]\n0,a\n1,b\n0,c\n",
       "words.csv:2:2: 'F [N]' (column 2) holds no numbers"},
      {"allwords.csv", "x,F\na,b\nc,d\n", "allwords.csv:3: no row down to 'c,d' has numbers"},
      {"nans.csv", "x [m],F [N]\nnan,nan\nnan,nan\n",
       "nans.csv:3: no row down to 'nan,nan' has numbers"},
      {"na.csv", "x [m],F [N]\n0,0\n#N/A,1\n0,2\n1,1\n", "na.csv:3:1: '#N/A' is not a number"},
      {"clock.csv", "0,0,0\n1,1,5\n2,0,-5\n3,-1,0\n",
       "4 samples are too few for 5 free parameters"},
      {"speed.csv", "speed,F [N]\n0,0\n1,1\n0,-1\n",
       "speed.csv: no column for the displacement: the columns are 'speed' (column 1), 'F [N]' "
       "(column 2)"},
      {"unfit.csv", "angle [deg],F [N]\n0,0\n1,1\n0,-1\n",
       "unfit.csv:1:2: the unit 'N' of 'F [N]' (column 2) is not known for the force"},
      {"nan.csv", "x [m],F [N]\n0,0\n1,nan\n2,1\n", "nan.csv:3:2: 'nan' is not a number"},
      {"text.csv", "x [m],F [N]\n0,0\n1,one\n2,1\n", "text.csv:3:2"},
      {"huge.csv", "x [m],F [N]\n0,0\n1e300,1\n-1e300,-1\n",
       "huge.csv:3:1: half the range of the "
       "displacement is 1e+300 m: must lie between 1e-100 and 1e100"},
      {"instant.csv", "t [s],x [m],F [N]\n0,0,0\n1e-310,1,1\n2e-310,-1,-1\n",
       "instant.csv:4:1: half the range of the time is 1e-310 s: must lie between 1e-100 and"},
      {"tiny.csv", "x [m],F [N]\n0,0\n1,1e-300\n-1,-1e-300\n0,0\n", "choose other units"}};
  for (const BadFile& file : files) {
    const TemporaryDirectory directory;
    const std::string path = directory.Write(file.name, file.content);
    ExpectRefused("fit " + path + " --json " + (directory.path() / "out.json").string(),
                  file.message);
    EXPECT_EQ(directory.FileCount(), 1u) << file.name << ": an output was left behind";
  }
}

class Config : public CommandTest {
 protected:
  Words FitWith(const std::string& toml) {
    return "fit " + SampleRecord() + " --config " + Write("options.toml", toml);
  }
};

TEST_F(Config, GivesOptions) {
  const json fit = JsonOf(FitWith("model = \"mindlin\"\nnormal-load = 50\n"));
  EXPECT_EQ(fit["model"], "mindlin");
  EXPECT_EQ(fit["contact"]["normal_load"]["value"], 50.0);
}

TEST_F(Config, TakesListsAndYieldsToTheCommandLine) {
  const json fit =
      JsonOf(FitWith("fix = [\"alpha=0.3\", \"force_offset=0\"]\nmodel = \"jenkins\"\n") +
             "--model mindlin-dahl");
  EXPECT_EQ(fit["model"], "mindlin-dahl");
  EXPECT_EQ(Value(fit, "alpha"), 0.3);
  EXPECT_EQ(fit["parameters"]["alpha"]["status"], "fixed");
  EXPECT_EQ(fit["parameters"]["force_offset"]["status"], "fixed");
}

TEST_F(Config, NeedsACommand) {
  ExpectRefused("--config " + Write("options.toml", "model = \"mindlin\"\n"),
                "A subcommand is required");
}

TEST_F(Config, RefusesWhatItDoesNotKnow) {
  for (const auto& [toml, message] :
       {std::pair("modle = \"mindlin\"\n", "'modle' is no option of fit"),
        {"[model]\nname = 1\n", "--model: name = 1 not in"},
        {"model = \"dahl\"\nb = 3:5\n", "options.toml:2:6: "},
        {"model = \"dahl\"\n\nmodel = \"mindlin\"\n", "options.toml:3:9: "},
        {"model = \"open\n", "options.toml:1:14: "},
        {"fix = [1, [2]]\n", "--fix: parameter '1' is unknown"},
        {"model = 2026-01-01\n", "--model: 2026-01-01 not in"},
        {"[fits]\nmodel = \"mindlin\"\n", "'fits' is no option of fit"},
        {"model = \"coulomb\"\n", "--model"},
        {"normal-load = \"heavy\"\n", "--normal-load"}}) {
    SCOPED_TRACE(toml);
    ExpectRefused(FitWith(toml), message);
  }
}

}  // namespace
}  // namespace mindahl::cli::usage_test
