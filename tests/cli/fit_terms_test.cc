
#include <cstdio>
#include <filesystem>
#include <ostream>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/histories.h"
#include "support/prelude.h"

// fit: what the model may have beside σ, α and Tc, which samples count and how much, the choice
// between models, and what the report says of each.
namespace mindahl::cli::fit_terms_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

// Mindlin's contact of every loop here: δc = 3Tc/(2σ) = 1.5 µm.
constexpr double kSigma = 4e7;
constexpr double kSlipForce = 40.0;
constexpr double kAmplitude = 1.95e-6;  // 1.3 δc
constexpr std::size_t kSamplesPerCycle = 200;
// Noise-free loops of 17 digits: the fit promises 1e-8; the terms here are correlated with σ and α
// by up to 0.99, which costs two digits.
constexpr double kNoiseFree = 1e-6;

struct Sample {
  double time = 0.0;
  double displacement = 0.0;
  double force = 0.0;
  double normal_load = 0.0;
};

class FitTerms : public ::testing::Test {
 protected:
  std::vector<Sample> Simulate(const Words& more) {
    Words words = {"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "1.3"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
    Words lines = testing::Lines(outcome.out);
    lines.erase(lines.begin());
    std::vector<Sample> loop;
    for (const std::string& line : lines) {
      const Words cells = testing::Cells(line);
      loop.push_back({std::stod(cells[0]), std::stod(cells[1]), std::stod(cells[2]), 100.0});
    }
    return loop;
  }

  std::string Write(const std::vector<Sample>& loop) {
    std::string text = "time [s],displacement [m],force [N],normal [N]\n";
    for (const Sample& sample : loop) {
      char line[120];
      std::snprintf(line, sizeof line, "%.17g,%.17g,%.17g,%.17g\n", sample.time,
                    sample.displacement, sample.force, sample.normal_load);
      text += line;
    }
    return directory_.Write("loop.csv", text).string();
  }

  json Fit(const std::vector<Sample>& loop, const Words& options = {}) {
    Words words = {"fit", Write(loop), "--json", "-"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
    EXPECT_THAT(outcome.Errors(), IsEmpty());
    return outcome.Json();
  }

  TemporaryDirectory directory_;
};

void ExpectContact(const json& fit, double tolerance) {
  EXPECT_NEAR(Value(fit, "sigma") / kSigma, 1, tolerance);
  EXPECT_NEAR(Value(fit, "alpha"), 1.0 / 3, tolerance);
  EXPECT_NEAR(Value(fit, "slip_force") / kSlipForce, 1, tolerance);
}

/// The rig's spring in series: it gives way by T/k.
std::vector<Sample> InRig(std::vector<Sample> loop, double stiffness) {
  for (Sample& sample : loop) sample.displacement += sample.force / stiffness;
  return loop;
}

TEST_F(FitTerms, KnownRigIsTakenOffTheDisplacement) {
  const json fit = Fit(InRig(Simulate({"--cycles", "2"}), 8e7), {"--rig-stiffness", "8e7"});
  ExpectContact(fit, kNoiseFree);
  const json& rig = fit["parameters"]["rig_stiffness"];
  EXPECT_EQ(rig["value"], 8e7);
  EXPECT_EQ(rig["unit"], "N/m");
  EXPECT_EQ(rig["status"], "fixed");
}

TEST_F(FitTerms, FilesUnderSeveralLoadsAreOneContact) {
  constexpr double kExponent = 0.5;
  Words words = {"fit"};
  int file = 0;
  for (const double load : {50.0, 100.0, 150.0}) {
    const double ratio = load / 100;
    std::vector<Sample> loop = Simulate({"--cycles", "2"});
    // σ ∝ N^p and Tc ∝ N: the same loop over N along N^{1−p} the way.
    for (Sample& sample : loop) {
      sample.displacement *= std::pow(ratio, 1 - kExponent);
      sample.force *= ratio;
    }
    const std::string path = Write(loop);
    const std::string name = (directory_.path() / (std::to_string(++file) + ".csv")).string();
    std::filesystem::rename(path, name);
    words.push_back(name);
  }
  words.insert(words.end(), {"--normal-load", "50,100±1%,150", "--json", "-"});
  const Outcome outcome = RunCommand(words);
  ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
  const json fit = outcome.Json();
  ExpectContact(fit, kNoiseFree);
  EXPECT_NEAR(Value(fit, "load_exponent"), kExponent, kNoiseFree);
  EXPECT_NEAR(fit["contact"]["friction_coefficient"]["value"].get<double>(), kSlipForce / 100,
              kNoiseFree);
  // 1 N of one of three loads.
  constexpr double kNormalQuantile = 1.959963984540054;
  EXPECT_NEAR(std::log(fit["contact"]["friction_coefficient"]["ci95"][1].get<double>() /
                       (kSlipForce / 100)),
              kNormalQuantile / 300, kNoiseFree);
}

TEST_F(FitTerms, SamplesOutsideTheLoadWindowDoNotCount) {
  std::vector<Sample> loop = Simulate({"--cycles", "2"});
  for (std::size_t i = 220; i < 260; ++i) {
    loop[i].normal_load = 50.0;
    loop[i].force *= 0.5;
  }
  const json fit = Fit(loop, {"--select", "load=95:105"});
  ExpectContact(fit, kNoiseFree);
  EXPECT_EQ(fit["input"]["left_out"][0]["samples"], 40);
  EXPECT_EQ(fit["input"]["samples"], loop.size());
  EXPECT_EQ(fit["contact"]["normal_load"]["value"], 100.0);
}

TEST_F(FitTerms, SamplesAndCyclesOutsideTheRangeDoNotCount) {
  std::vector<Sample> loop = Simulate({"--cycles", "3"});
  // Spoilt before the second cycle, which begins at three quarters, and from sample 500 on.
  for (std::size_t i = 0; i < 150; ++i) loop[i].force *= 0.8;
  for (std::size_t i = 499; i < loop.size(); ++i) loop[i].force *= 0.9;
  const json fit = Fit(loop, {"--select", "cycles=2:4", "--select", "samples=1:499"});
  ExpectContact(fit, kNoiseFree);
  EXPECT_EQ(fit["input"]["left_out"][0]["samples"], 150 + loop.size() - 499);
}

TEST_F(FitTerms, SlipForcesOfBothDirectionsAreFitted) {
  std::vector<Sample> loop = Simulate({"--cycles", "2"});
  testing::History displacement;
  for (const Sample& sample : loop) displacement.push_back(sample.displacement);
  testing::History force(loop.size());
  const models::FrictionModel& model = *models::FindFrictionModel("mindlin");
  models::EvaluateForce(
      model, {.tangential_stiffness = kSigma, .slip_force = kSlipForce},
      models::MakeLoadingPath(displacement, loop::FindReversals(displacement, 0.0), model.memory,
                              {.asymmetry = 0.2}),
      displacement, force);
  for (std::size_t i = 0; i < loop.size(); ++i) loop[i].force = force[i];
  const json fit = Fit(loop, {"--terms", "asymmetry"});
  ExpectContact(fit, kNoiseFree);
  EXPECT_NEAR(Value(fit, "asymmetry"), 0.2, kNoiseFree);
  const json& forces = fit["contact"];
  EXPECT_NEAR(forces["slip_force_positive"]["value"].get<double>() / (1.2 * kSlipForce), 1,
              kNoiseFree);
  EXPECT_NEAR(forces["slip_force_negative"]["value"].get<double>() / (0.8 * kSlipForce), 1,
              kNoiseFree);
  EXPECT_FALSE(Fit(Simulate({"--cycles", "2"}))["contact"].contains("slip_force_positive"));
  // From the second cycle on the contact has slipped, and only the zero of the force tells.
  const std::vector<Sample> cycled(loop.begin() + kSamplesPerCycle, loop.end());
  const json known = Fit(cycled, {"--terms", "asymmetry", "--fix", "force_offset=0"});
  EXPECT_EQ(known["initial_state"], "steady");
  EXPECT_NEAR(Value(known, "asymmetry"), 0.2, kNoiseFree);
}

TEST_F(FitTerms, ForceOfAColumnIsFittedOrTakenOff) {
  constexpr double kPerNewton = 0.3;
  std::vector<Sample> loop = Simulate({"--cycles", "2"});
  for (std::size_t i = 0; i < loop.size(); ++i) {
    loop[i].normal_load = 100 + 10 * std::sin(0.021 * static_cast<double>(i));
    loop[i].force += kPerNewton * loop[i].normal_load;
  }
  for (const char* option : {"normal", "4=fit", "normal=0.3"}) {
    const json fit = Fit(loop, {"--covariate", option});
    ExpectContact(fit, kNoiseFree);
    const char* const name = option[0] == '4' ? "covariate_4" : "covariate_normal";
    EXPECT_NEAR(Value(fit, name), kPerNewton, kNoiseFree * kSlipForce) << option;
    EXPECT_EQ(fit["parameters"][name]["unit"], "N/N");
  }
}

struct Misuse {
  const char* name;
  Words options;
  const char* message;

  friend void PrintTo(const Misuse& misuse, std::ostream* out) { *out << misuse.name; }
};

class MisuseOfFit : public FitTerms, public ::testing::WithParamInterface<Misuse> {};

TEST_P(MisuseOfFit, ExitsWithTwoAndOneLineThatSaysWhatToDo) {
  Words words = {"fit", Write(Simulate({"--cycles", "2"}))};
  words.insert(words.end(), GetParam().options.begin(), GetParam().options.end());
  const Outcome outcome = RunCommand(words);
  EXPECT_EQ(outcome.status, cli::kBadInput);
  EXPECT_THAT(outcome.out, IsEmpty());
  ASSERT_THAT(outcome.Errors(), SizeIs(1));
  EXPECT_THAT(outcome.Errors()[0], HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    FitTerms, MisuseOfFit,
    ::testing::Values(
        Misuse{"RigThatIsNoNumber",
               {"--rig-stiffness", "soft"},
               "--rig-stiffness: 'soft' is not a number"},
        Misuse{"RigOfNoStiffness",
               {"--rig-stiffness", "0"},
               "--rig-stiffness [N/m] = 0 is invalid: must be finite and > 0"},
        Misuse{"StartOfARigThatIsNotFitted",
               {"--start", "rig_stiffness=1e8"},
               "--start: rig_stiffness is not fitted, so this has no effect: add --rig-stiffness "
               "fit"},
        Misuse{"BoundOfASlopeThatIsNotFitted",
               {"--bound", "plateau_slope=0:1"},
               "--bound: plateau_slope is not fitted, so this has no effect: add --terms "
               "plateau_slope"},
        Misuse{"TermMisspelt", {"--terms", "viscos"}, "did you mean 'viscous'?"},
        Misuse{"TermThatIsNoColumnEither",
               {"--terms", "pressure"},
               "no column is called 'pressure' (for the covariate): the columns are"},
        Misuse{"SelectionOfNothing",
               {"--select", "load"},
               "--select: 'load' is incomplete: write cycles=LO:HI, time, load or samples"},
        Misuse{"SelectionOfWhatIsNone", {"--select", "cycle=1:2"}, "did you mean 'cycles'?"},
        Misuse{"LoadWindowOfOneNumber",
               {"--select", "load=5"},
               "--select load: '5' is incomplete: write LO:HI in newtons"},
        Misuse{"LoadWindowUpsideDown",
               {"--load-window", "5:4"},
               "'5:4' is empty: the first number must be the smaller"},
        Misuse{"LoadWindowWithoutSamples",
               {"--select", "load=5:6"},
               "--select load=5:6 holds no sample: the normal load runs from 100 to 100 N"},
        Misuse{"LagBeyondTheRecord", {"--fix", "lag=1e6"}, "nothing is left of record 1"},
        Misuse{"AsymmetryOfOneSense",
               {"--fix", "asymmetry=1"},
               "asymmetry [-] = 1 is invalid: must be in (-1, 1)"},
        Misuse{"AsymmetryOfDahlsLawBehindARig",
               {"--terms", "asymmetry", "--model", "dahl", "--rig-stiffness", "fit"},
               "asymmetry and rig_stiffness of dahl"},
        Misuse{"AsymmetryOfACycledContact",
               {"--terms", "asymmetry", "--initial-state", "steady"},
               "asymmetry cannot be distinguished from force_offset: the contact had slipped "
               "before the fitted samples"},
        Misuse{"CovariateWithoutAValue",
               {"--covariate", "normal="},
               "--covariate: 'normal=' is incomplete: write COL[=C|fit], e.g. pressure=50"},
        Misuse{"CovariateOfAWord",
               {"--covariate", "normal=much"},
               "--covariate: 'much' is not a number: write COL[=C|fit], e.g. pressure=50"},
        Misuse{"CovariateTwice",
               {"--covariate", "normal", "--covariate", "normal=3"},
               "is chosen twice as a covariate: choose it once"},
        Misuse{"CovariateThatIsNoColumn",
               {"--covariate", "pressure"},
               "no column is called 'pressure' (for the covariate): the columns are"},
        Misuse{"CyclesBeyondTheRecord",
               {"--select", "cycles=40:50"},
               "cycles 40:50 contain nothing of record 1: it has"},
        Misuse{"CyclesFromNone",
               {"--cycles", "0:2"},
               "--cycles: '0' is not a whole number from 1 on: write LO:HI, counted from 1, e.g. "
               "2:5"},
        Misuse{"SamplesUpsideDown",
               {"--select", "samples=5:4"},
               "--select samples: '5:4' is empty: the first number must not be the larger"},
        Misuse{"SamplesBeyondTheRecord",
               {"--samples", "100000:200000"},
               "samples 100000:200000 contain nothing of record 1: it has"},
        Misuse{"NegativeDisplacementNoise",
               {"--displacement-noise", "-1e-9"},
               "--displacement-noise [m] = -1e-09 is invalid: must be finite and >= 0"},
        Misuse{"UnknownLoss",
               {"--loss", "l1"},
               "--loss: 'l1' is unknown: must be one of none, huber, cauchy, tukey; see mindahl "
               "fit --help"},
        Misuse{"UnknownModel", {"--model", "best"}, "--model: 'best' is unknown: must be one of"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(FitCommand, LoadWindowWithoutALoadNamesTheColumnOption) {
  const Outcome outcome = RunCommand({"fit", testing::SampleRecord(), "--select", "load=1:2"});
  EXPECT_EQ(outcome.status, cli::kBadInput);
  ASSERT_THAT(outcome.Errors(), SizeIs(1));
  EXPECT_THAT(outcome.Errors()[0],
              HasSubstr("--select load=LO:HI needs a normal load in every record: name its "
                        "column with --normal-load-column"));
}

TEST(FitCommand, LoadsThatHaveNoMeaningAreRefused) {
  const auto error = [](const Words& more) {
    Words words = {"fit", testing::SampleRecord()};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, cli::kBadInput);
    return outcome.Errors().empty() ? std::string() : outcome.Errors()[0];
  };
  EXPECT_THAT(error({"--normal-load", "25,50"}), HasSubstr("2 loads for 1 file"));
  EXPECT_THAT(error({"--normal-load", "25,"}), HasSubstr("--normal-load: ''"));
  EXPECT_THAT(error({"--fix", "load_exponent=0.5"}), HasSubstr("load_exponent has no effect"));
  EXPECT_THAT(error({"--start", "load_exponent=0.5"}), HasSubstr("load_exponent has no effect"));
  EXPECT_THAT(error({"--bound", "load_exponent=0:1"}), HasSubstr("load_exponent has no effect"));
}

}  // namespace
}  // namespace mindahl::cli::fit_terms_test
