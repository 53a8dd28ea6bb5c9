#include <filesystem>

#include "cli/command_line.h"
#include "support/measured.h"

// The answers of `fit` do not mislead: each test is one kind of answer that once did.
namespace mindahl::cli::answers_test {
namespace {

/// A command, and what its text must say and must not say. "@" stands for the folder of files that
/// are made here, "data/" and "measured/" for theirs.
struct Answer {
  std::string name;
  Words words;
  std::vector<std::string> says;
  std::vector<std::string> never = {};

  friend void PrintTo(const Answer& answer, std::ostream* out) { *out << answer.name; }
};

const Words kMaterials =
    "--normal-load 50 --radius-2 inf --youngs-modulus-1 210GPa --poisson-1 0.3 "
    "--youngs-modulus-2 210GPa --poisson-2 0.3";
const Words kSeal = {"--displacement", "5 [mm]", "--force", "7 [N]", "--time", "1 [ms]"};

const std::vector<Answer> kAnswers = {
    {"PlateausThatDifferByAnOffsetAreNoSlipForcesOfTwoDirections",
     "fit measured/mr_damper_utfsm/25mm_0.25Hz_0.5A.csv",
     {"half gap 69", "Tc 6"},
     {"Tc up", "asymmetry", "--terms speed_exponent"}},
    {"APressureThatIsNamedIsFitted",
     Words("fit measured/seals/Circle_2bar.csv --covariate 6") + kSeal,
     {"covariate_6 4", "Tc 5."},
     {"repeats"}},
    {"APressureThatMakesTheForceIsTriedFirst",
     Words("fit measured/seals/Circle_2bar.csv") + kSeal,
     {"next          --covariate 3: "},
     {"repeats"}},
    {"AContactBehindARigSaysThatItIsTheRig",
     "fit measured/tribometer/test_data_2.txt",
     {"a rig of 45", "Mindlin's 1/3 fits in a compliant rig", "measured "},
     {"rejected", "tenable", " ± 0.044", "drifts"}},
    {"TheSameContactWithTheTermThatIsAdvisedSaysSoToo",
     "fit measured/tribometer/test_data_2.txt --terms slip_position",
     {"a rig of 4", "Mindlin's 1/3 fits in a compliant rig"},
     {"rejected"}},
    {"ARigThatIsConfoundedLeavesNoStiffness",
     "fit data/behind_a_rig.csv",
     {"(32.2 … 49.1)", "0.333)", "in a compliant rig", "a rig of 101 N/µm"},
     {"identifiable"}},
    {"ColumnsAreNamedAndTheFrictionTorqueIsTheTorque",
     "fit data/joint.csv",
     {"torque 'friction torque [N m]' (3)"}},
    {"AKnownRigCountsOnceInAPlan",
     "plan --record data/raw_rig_record.csv --rig-stiffness 80e6",
     {"sigma = 4.81", "noise 0.069"},
     {"sigma = 3.2"}},
    {"OneCycleFromPeakToPeakIsSteady",
     "fit @peak.csv",
     {"Tc 14.99", "like noise"},
     {"virgin", "not determined"}},
    {"AClippedForceIsNoSlipForce",
     "fit @clipped.csv",
     {"the force reads 9 N in ", "the sensor is at its limit, and Tc is no less"},
     {"next ", "rejected"}},
    {"FilesOfBothSignsOfTheForceAreNamed",
     "fit @loop.csv @turned.csv",
     {"check ", "turned.csv has another sign than that of the rest: turn it in the file"},
     {"next "}},
    {"NoiseIsNoLoop", "fit @noise.csv", {"no loop is seen"}, {"Tc ", "adequate", "sliding"}},
    {"AnErrorOfAConversionStandsWithItsNumbers",
     "convert --sigma 5e7 --slip-force 15 --amplitude 3e-7 --to lugre --input-lines -",
     {"# at 3e-07 m the force is within ", "sigma0 = "}},
    {"ACurvatureOfATorqueIsPerSquareRadian",
     "fit @gravity.csv --terms slip_position_quadratic",
     {"N m/rad²"},
     {"N/m²"}},
    {"GravityOfAJointIsAForceOfPosition",
     "fit @gravity.csv",
     {"--terms slip_position_quadratic", "force and slip force that depend on the position"}},
};

class MisleadingAnswer : public CommandTest, public ::testing::WithParamInterface<Answer> {
 protected:
  MisleadingAnswer() {
    const auto loop = Lines(Done("simulate --sigma 5e7 --slip-force 15 --lambda 1.5 --cycles 3 "
                                 "--noise-force 0.05")
                                .out);
    std::string peak = loop[0] + "\n";
    for (std::size_t i = 251; i <= 451; ++i) peak += loop[i] + "\n";  // from a peak to the next
    Write("peak.csv", peak);
    Write("loop.csv", fmt::format("{}\n", fmt::join(loop, "\n")));
    const auto write_with = [&](const char* name, const auto& change) {  // of the last column
      std::string changed = loop[0] + "\n";
      for (std::size_t i = 1; i < loop.size(); ++i) {
        const std::size_t comma = loop[i].rfind(',') + 1;
        const double force = std::stod(loop[i].substr(comma));
        changed += fmt::format("{}{}\n", loop[i].substr(0, comma), change(force));
      }
      Write(name, changed);
    };
    write_with("turned.csv", [](double force) { return -force; });
    write_with("clipped.csv", [](double force) { return std::clamp(force, -9.0, 9.0); });
    Generator generator(1);
    std::string noise = "x [um],F [N]\n";
    for (int i = 0; i < 400; ++i) {
      noise += fmt::format("{},{}\n", testing::Normal(generator), testing::Normal(generator));
    }
    Write("noise.csv", noise);
    // Friction of 2 N m, which builds up over some mrad, and a load of 6 N m that is lifted.
    std::string gravity = "time [s],angle [rad],torque [N m]\n";
    double friction = 0.0;
    double before = 0.0;
    for (int i = 0; i <= 1200; ++i) {
      const double angle = 0.5 * std::sin(2 * std::numbers::pi * i / 400);
      const double step = (angle - before) / 0.005;
      friction = std::clamp(friction + step, -1.0, 1.0);
      before = angle;
      gravity +=
          fmt::format("{},{},{}\n", 0.01 * i, angle,
                      2 * friction + 6 * std::sin(angle + 0.5) + 0.01 * testing::Normal(generator));
    }
    Write("gravity.csv", gravity);
  }

  /// Returns the path of a file; empty where a measured record is absent.
  std::string PathOf(const std::string& word) const {
    if (word.starts_with("data/")) return std::string(MINDAHL_SOURCE_DIR) + "/" + word;
    if (word.starts_with("@")) return Path(word.substr(1));
    if (!word.starts_with("measured/")) return word;
    const std::string path = MeasuredPath(word.substr(9));
    return std::filesystem::exists(path) ? path : "";
  }
};

TEST_P(MisleadingAnswer, IsGivenNoMore) {
  const Answer& answer = GetParam();
  Words words;
  for (const std::string& word : answer.words) words.push_back(PathOf(word));
  if (std::ranges::count(words, "") > 0) GTEST_SKIP() << "no measured record";
  const Outcome outcome = Done(words);
  // Lines are broken between words.
  std::string text;
  for (const std::string& line : Lines(outcome.out)) {
    const std::size_t first = line.starts_with(' ') ? line.find_first_not_of(' ') : 0;
    text += (first > 0 && first != std::string::npos ? " " : "\n") +
            line.substr(std::min(first, line.size()));
  }
  for (const std::string& said : answer.says) EXPECT_THAT(text, HasSubstr(said));
  for (const std::string& said : answer.never) EXPECT_THAT(text, Not(HasSubstr(said)));
}

INSTANTIATE_TEST_SUITE_P(Text, MisleadingAnswer, ::testing::ValuesIn(kAnswers),
                         [](const auto& row) { return row.param.name; });

using DefaultText = CommandTest;

// Words of the default text, notes included: 150 of a clean loop, 200 of a doubtful one, 120 of one
// that the law does not describe.
TEST_F(DefaultText, IsShort) {
  std::vector<Words> fits = {"fit --radius-1 50mm " + SampleRecord() + kMaterials};
  for (const auto& entry : std::filesystem::directory_iterator(MINDAHL_SOURCE_DIR "/data")) {
    if (entry.path().extension() == ".csv") fits.push_back("fit " + entry.path().string());
  }
  for (const Words& fit : fits) {
    const Outcome outcome = Done(fit + Words{"--json", Path("fit.json")});
    const std::string verdict = json::parse(FileContent(Path("fit.json")))["adequacy"]["verdict"];
    EXPECT_THAT(outcome.err, IsEmpty());
    EXPECT_LE(Words(outcome.out).size(), verdict == "adequate"   ? 150U
                                         : verdict == "doubtful" ? 200U
                                                                 : 120U)
        << outcome.out;
  }
}

}  // namespace
}  // namespace mindahl::cli::answers_test
