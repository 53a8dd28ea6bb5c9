#include "cli/command_line.h"
#include "mindahl/models/variable_load.h"

// fit: one file under several constant loads.
namespace mindahl::cli::load_steps_test {
namespace {

constexpr double kFriction = 0.4;
constexpr double kAmplitude = 6e-7;  // slips grossly at 20 N, partly at 50 and 100 N
constexpr std::size_t kCycle = 100;  // samples
/// Residuals are rounding errors; pieces that start from an extreme have one offset with their
/// origin, and σ, α and p are correlated by 0.99, which costs two digits each.
constexpr double kNoiseFree = 1e-5;

class LoadStepsOfFit : public CommandTest {
 protected:
  /// Fifteen cycles: the exact response of elements in parallel, so that the contact keeps what it
  /// has of each load.
  std::string Series(const std::function<double(double)>& load_at) {
    models::LoadedContactState contact(
        {.friction_coefficient = kFriction, .reference_load = 50, .reference_stiffness = 4e7},
        {.normal_load = load_at(0)});
    std::string rows = "displacement [m],force [N],normal load [N]\n";
    for (std::size_t i = 0; i <= 15 * kCycle; ++i) {
      const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
      const double displacement = kAmplitude * std::sin(2 * std::numbers::pi * cycle);
      rows += fmt::format("{},{},{}\n", displacement, contact.Move(displacement, load_at(cycle)),
                          load_at(cycle));
    }
    return Write("series.csv", rows);
  }

  static void ExpectOneRecord(const Words& fit) {
    const json followed = JsonOf(fit);
    EXPECT_EQ(followed["input"]["files"].size(), 1U);
    EXPECT_FALSE(followed["parameters"].contains("load_exponent"));
  }
};

double Staircase(double cycle) { return cycle < 5 ? 20.0 : cycle < 10 ? 50.0 : 100.0; }

TEST_F(LoadStepsOfFit, MakeALoadSeriesOfOneFile) {
  const std::string file = Series(Staircase);
  const json fit = JsonOf("fit " + file);
  EXPECT_NEAR(Value(fit, "load_exponent"), 1.0 / 3, kNoiseFree);
  EXPECT_NEAR(Value(fit, "alpha"), 1.0 / 3, kNoiseFree);
  EXPECT_NEAR(fit["contact"]["friction_coefficient"]["value"].get<double>(), kFriction, kNoiseFree);
  // Line 1 is the header; a piece begins with the second turn of the sine after the step.
  ASSERT_EQ(fit["input"]["files"].size(), 3U);
  EXPECT_EQ(fit["input"]["files"][1], file + ":577-1001");
  EXPECT_EQ(fit["input"]["left_out"][0]["samples"], 2 * (3 * kCycle / 4));
  EXPECT_EQ(fit["input"]["left_out"][0]["why"], "another load");
  EXPECT_THAT(Done("fit " + file).out, HasSubstr("150 samples (another load)"));
}

TEST_F(LoadStepsOfFit, AreFollowedInOneRecordWithLoadOrWindow) {
  const std::string fit = "fit " + Series(Staircase);
  for (const char* more : {" --normal-load 56.6", " --samples 1:1200", " --load-window 15:105"}) {
    ExpectOneRecord(fit + more);
  }
}

TEST_F(LoadStepsOfFit, AreNotSeenInALoadThatChangesSlowlyOrSwings) {
  ExpectOneRecord("fit " + Series([](double cycle) { return 20 + 80 * cycle / 15; }));
  ExpectOneRecord("fit " + Series([](double cycle) {
                    return 50 * (1 + 0.3 * std::sin(2 * std::numbers::pi * cycle / 7));
                  }));
}

}  // namespace
}  // namespace mindahl::cli::load_steps_test
