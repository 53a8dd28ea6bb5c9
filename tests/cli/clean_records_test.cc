

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// What is measured of a contact that is the model's is not to be doubted.
namespace mindahl::cli::clean_records_test {
namespace {

using Words = std::vector<std::string>;

Outcome FitOf(Words drive, const Words& options) {
  const TemporaryDirectory directory;
  const std::string file = directory.path() / "loop.csv";
  Words simulate = {"simulate", "--sigma", "1e7", "--slip-force", "10", "--noise-force",
                    "0.05",     "-o",      file};
  simulate.insert(simulate.end(), drive.begin(), drive.end());
  EXPECT_EQ(RunCommand(simulate).status, kDone);
  Words fit = {"fit", file, "--json", "-"};
  fit.insert(fit.end(), options.begin(), options.end());
  return RunCommand(fit);
}

TEST(CleanRecord, OfCyclesThatDoNotCloseIsIdentified) {
  for (const Words& drive : std::vector<Words>{
           {"--waveform", "growing-sine", "--lambda", "3", "--cycles", "6", "--growth", "30"},
           {"--waveform", "growing-sine", "--lambda", "3", "--cycles", "2", "--growth", "3"},
           {"--waveform", "nested", "--lambda", "1.5", "--cycles", "6"},
           {"--waveform", "random", "--lambda", "2", "--cycles", "10", "--seed", "1"}}) {
    const Outcome fit = FitOf(drive, {"--strict"});
    EXPECT_EQ(fit.status, kDone) << drive[1] << ": " << fit.err;
  }
}

TEST(CleanRecord, WithNoiseOfTheDisplacementIsAdequate) {
  constexpr int kRecords = 12;
  constexpr int kMostDoubted = 1;  // the verdict states one in 200
  int doubted = 0;
  for (int seed = 1; seed <= kRecords; ++seed) {
    const Outcome fit = FitOf({"--lambda", "1.5", "--cycles", "3", "--noise-displacement", "5e-8",
                               "--seed", std::to_string(seed)},
                              {});
    doubted += fit.Json()["adequacy"]["verdict"] == "adequate" ? 0 : 1;
  }
  EXPECT_LE(doubted, kMostDoubted);
}

}  // namespace
}  // namespace mindahl::cli::clean_records_test
