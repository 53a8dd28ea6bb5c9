
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/measured.h"
#include "support/prelude.h"

// What a fit advises is accepted, and named first where it is right.
namespace mindahl::cli::advice_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

Words SplitWords(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Follows the first advice that there is, as often as there is one, up to four times.
/// @returns the options that were followed
Words FollowAdvice(Words fit) {
  Words followed;
  std::set<std::string> given;
  for (int step = 0; step < 4; ++step) {
    const Outcome outcome = RunCommand(fit);
    EXPECT_NE(outcome.status, kBadInput) << outcome.err << ::testing::PrintToString(fit);
    if (outcome.status == kBadInput || outcome.out.empty()) break;
    std::string advice;
    const json causes = outcome.Json()["adequacy"]["causes"];
    for (const json& cause : causes) {
      if (cause["try"].is_null() || given.contains(cause["try"])) continue;
      advice = cause["try"];
      break;
    }
    if (advice.empty()) break;
    given.insert(advice);
    followed.push_back(advice);
    for (const std::string& word : SplitWords(advice)) fit.push_back(word);
  }
  return followed;
}

/// A loop of a contact that slips, with something beside it.
std::string RecordWith(const TemporaryDirectory& directory, const char* name,
                       const std::function<double(double x, double v, double force)>& beside) {
  const std::string clean = directory.path() / "clean.csv";
  EXPECT_EQ(RunCommand({"simulate", "--sigma", "4e7", "--slip-force", "40", "--amplitude", "3e-5",
                        "--cycles", "4", "--samples-per-cycle", "200", "--noise-force", "0.1", "-o",
                        clean})
                .status,
            kDone);
  std::string text = "time [s],displacement [m],force [N]\n";
  std::ifstream in(clean);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    const Words cells = testing::Cells(line);
    const double t = std::stod(cells[0]);
    const double x = std::stod(cells[1]);
    const double force = std::stod(cells[2]);
    const double v = std::cos(2 * std::acos(-1.0) * t);
    std::ostringstream row;
    row.precision(12);
    row << t << ',' << x << ',' << force + 40 * beside(x / 3e-5, v, force / 40) << '\n';
    text += row.str();
  }
  return directory.Write(name, text).string();
}

TEST(Advice, IsNeverRefusedHoweverFarItIsFollowed) {
  const TemporaryDirectory directory;
  const auto record = RecordWith(directory, "many.csv", [](double x, double v, double force) {
    return 0.1 * x + 0.2 * std::copysign(std::sqrt(std::abs(v)), v) + 0.05 * force * x +
           0.05 * std::abs(force);
  });
  for (const Words& beside : {Words{}, Words{"--plateau-slope"}, Words{"--model", "dahl"},
                              Words{"--initial-state", "steady"}, Words{"--lag", "fit"},
                              Words{"--asymmetry", "fit", "--initial-state", "virgin"}}) {
    Words fit = {"fit", record, "--json", "-"};
    fit.insert(fit.end(), beside.begin(), beside.end());
    SCOPED_TRACE(::testing::PrintToString(beside));
    FollowAdvice(fit);
  }
}

TEST(Advice, OfMeasuredRecordsIsNeverRefused) {
  const Words columns = {"--displacement", "5 [mm]", "--force", "7 [N]", "--time", "1 [ms]"};
  for (const char* seal : {"Circle_1bar", "KDN_5bar", "Kidney_lc_7bar"}) {
    const std::string file = testing::MeasuredPath("seals/" + std::string(seal) + ".csv");
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no measured record " << file;
    SCOPED_TRACE(seal);
    Words fit = {"fit", file, "--json", "-", "--plateau-slope"};
    fit.insert(fit.end(), columns.begin(), columns.end());
    FollowAdvice(fit);
  }
}

TEST(FirstCause, OfMeasuredRecordsMatchesTheirDescription) {
  struct Measured {
    const char* file;
    const char* cause;  // the first
    Words options;
  };
  const Words seal = {"--displacement", "5 [mm]", "--force", "7 [N]", "--time", "1 [ms]"};
  for (const Measured& measured :
       {Measured{"band_brake/dataset-1_0.5Hz70lbtension.csv", "backlash", {}},
        Measured{"band_brake/dataset-2_0.25Hz30lbtension1.5amplitude.csv", "backlash", {}},
        Measured{"mr_damper_utfsm/10mm_2Hz_1A.csv", "speed_power", {}},
        Measured{"mr_damper_utfsm/25mm_0.25Hz_0.5A.csv", "speed_power", {}},
        Measured{"mr_damper_utfsm/25mm_0.5Hz_0A.csv", "speed_power", {}},
        Measured{"mr_damper_utfsm/5mm_3Hz_0.5A.csv", "speed_power", {}},
        Measured{"seals/Kidney_lc_7bar.csv", "plateau_slope", seal}}) {
    const std::string file = testing::MeasuredPath(measured.file);
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no measured record " << file;
    SCOPED_TRACE(measured.file);
    // The law alone is fitted, since a cause that is added as a term is one no longer.
    Words fit = {"fit", file, "--terms", "none", "--json", "-"};
    fit.insert(fit.end(), measured.options.begin(), measured.options.end());
    const Outcome outcome = RunCommand(fit);
    ASSERT_EQ(outcome.status, kDone) << outcome.err;
    const json causes = outcome.Json()["adequacy"]["causes"];
    ASSERT_FALSE(causes.empty());
    EXPECT_EQ(causes[0]["code"], measured.cause);
  }
}

TEST(Text, OfAMeasuredBrakeHasASlipForceThatContainsTheHalfGap) {
  const std::string file = testing::MeasuredPath("band_brake/dataset-1_0.5Hz70lbtension.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no measured record " << file;
  const json fit = RunCommand({"fit", file, "--terms", "none", "--json", "-"}).Json();
  const json& slip_force = fit["parameters"]["slip_force"];
  EXPECT_EQ(slip_force["identifiability"], "effective");
  EXPECT_LE(slip_force["ci95"][0], fit["measured"]["half_gap"]["value"]);
  EXPECT_GE(slip_force["ci95"][1], fit["measured"]["half_gap"]["value"]);
}

// A step at zero force in every stroke is no compliance: with the gap the misfit is half as large.
TEST(Backlash, OfAMeasuredBrakeHalvesTheMisfit) {
  const std::string file = testing::MeasuredPath("band_brake/dataset-1_0.5Hz70lbtension.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no measured record " << file;
  const auto misfit = [](const json& fit) {
    return fit["adequacy"]["misfit_over_half_gap"].get<double>();
  };
  const json alone = RunCommand({"fit", file, "--terms", "none", "--json", "-"}).Json();
  const json with = RunCommand({"fit", file, "--backlash", "fit", "--json", "-"}).Json();
  EXPECT_LT(misfit(with), 0.6 * misfit(alone));
}

}  // namespace
}  // namespace mindahl::cli::advice_test
