#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// These tests read a path from a file and simulate its loop with noise, rows and headers.
namespace mindahl::cli::simulate_command_test {
namespace {

using Words = std::vector<std::string>;

class SimulateFile : public ::testing::Test {
 protected:
  Outcome Simulated(const std::string& rows, Words words) {
    words.insert(words.begin(),
                 {"simulate", "--path", directory_.Write("path.csv", rows).string()});
    return RunCommand(words);
  }
  /// Returns a column of what is written.
  std::vector<double> Column(std::size_t k, const std::string& rows, const Words& words) {
    const Outcome outcome = Simulated(rows, words);
    EXPECT_EQ(outcome.status, kDone) << outcome.err;
    std::vector<double> values;
    const Words lines = Lines(outcome.out);
    for (std::size_t i = 1; i < lines.size(); ++i) {
      values.push_back(std::stod(Cells(lines[i]).at(k)));
    }
    return values;
  }
  std::vector<double> Force(const std::string& rows, const Words& words) {
    return Column(2, rows, words);
  }

  TemporaryDirectory directory_;
};

TEST_F(SimulateFile, AddsNoiseOfTheDeviationsThatAreAsked) {
  std::string rows = "x [um]\n";
  for (int i = 0; i < 4000; ++i) rows += i % 2 == 0 ? "0\n" : "1\n";
  const auto with = [](Words more) {
    more.insert(more.begin(), {"--sigma", "4e7", "--slip-force", "40"});
    return more;
  };
  const auto deviation = [](const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(squares / static_cast<double>(a.size()));
  };
  const Words noisy = with({"--noise-force", "0.5", "--noise-displacement", "2e-8"});
  const std::vector<double> force = Force(rows, noisy);
  // A deviation of 4000 is known to 1/√8000; five of that.
  constexpr double kScatter = 5 * 0.0112;
  EXPECT_NEAR(deviation(force, Force(rows, with({}))) / 0.5, 1.0, kScatter);
  EXPECT_NEAR(deviation(Column(1, rows, noisy), Column(1, rows, with({}))) / 2e-8, 1.0, kScatter);
  EXPECT_NE(Force(rows, with({"--noise-force", "0.5", "--seed", "2"})), force);
  EXPECT_THAT(Simulated(rows, with({"--noise-force", "-1"})).err, HasSubstr("--noise-force [N]"));
}

}  // namespace
}  // namespace mindahl::cli::simulate_command_test
