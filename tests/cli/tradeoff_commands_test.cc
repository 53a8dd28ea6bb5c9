
#include <filesystem>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// simulate --method and tradeoff.
namespace mindahl::cli::tradeoff_commands_test {
namespace {

using Words = std::vector<std::string>;

std::vector<double> Forces(Words words) {
  words.insert(words.begin(),
               {"simulate", "--sigma", "1", "--slip-force", "1", "--amplitude", "1.2"});
  const Outcome outcome = RunCommand(words);
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  std::vector<double> forces;
  const Words lines = Lines(outcome.out);
  for (std::size_t i = 1; i < lines.size(); ++i) forces.push_back(std::stod(Cells(lines[i]).at(2)));
  return forces;
}

double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b.at(i)));
  return largest;
}

TEST(SimulateMethod, EveryOneComesNearTheClosedForm) {
  const std::vector<double> exact = Forces({});
  constexpr double kNear = 0.02;  // of Tc, at the methods' default resolution
  for (const char* method : {"exact", "dopri5", "iwan", "table"}) {
    EXPECT_LT(LargestDifference(Forces({"--method", method}), exact), kNear) << method;
  }
}

TEST(SimulateMethod, SpringAndCoulombAreModels) {
  const std::vector<double> spring = Forces({"--model", "spring", "--samples-per-cycle", "4"});
  ASSERT_THAT(spring, SizeIs(5));
  EXPECT_EQ(spring[1], 1.2);
  EXPECT_EQ(spring[3], -1.2);
  EXPECT_THAT(Forces({"--model", "coulomb", "--samples-per-cycle", "4"}),
              ElementsAre(0, 1, -1, -1, 1));
}

struct Refusal {
  Words words;
  std::string said;
};

TEST(SimulateMethod, RefusesOptionsWithoutEffectNamingTheRemedy) {
  for (const Refusal& refusal : {
           Refusal{{"--steps", "3", "--amplitude", "1"}, "choose another method"},
           Refusal{{"--method", "table", "--tolerance", "1e-3", "--amplitude", "1"},
                   "--method dopri5"},
           Refusal{{"--method", "dopri5", "--steps", "0", "--amplitude", "1"}, "from 1 to"},
           Refusal{{"--method", "iwan", "--model", "dahl", "--amplitude", "1"},
                   "cannot compute model dahl"},
           Refusal{{"--method", "table", "--model", "spring", "--amplitude", "1"},
                   "cannot compute --model spring"},
           Refusal{{"--method", "leapfrog", "--amplitude", "1"}, "leapfrog"},
       }) {
    Words words = {"simulate", "--sigma", "1", "--slip-force", "1"};
    words.insert(words.end(), refusal.words.begin(), refusal.words.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, cli::kBadInput);
    ASSERT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.Errors()[0], HasSubstr(refusal.said));
  }
}

TEST(Tradeoff, WritesTableCsvAndPlot) {
  const TemporaryDirectory directory;
  const std::filesystem::path csv = directory.path() / "points.csv";
  const std::filesystem::path plot = directory.path() / "points.svg";
  const Outcome outcome = RunCommand(
      {"tradeoff", "--excitation", "micro", "--csv", csv.string(), "--plot", plot.string()});
  ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr(": mindlin by exact, "), HasSubstr("\n  simplified-dahl  exact ")));
  EXPECT_THAT(Lines(FileContent(csv)), SizeIs(1 + 6 + 15));
  EXPECT_THAT(FileContent(plot), HasSubstr("<svg"));
}

TEST(Tradeoff, NamesTheCheapestAlongAPath) {
  const TemporaryDirectory directory;
  const auto cheapest = [&](const char* lambda) {
    const std::string path = directory.path() / "path.csv";
    EXPECT_EQ(RunCommand({"simulate", "--sigma", "1", "--slip-force", "1", "--lambda", lambda,
                          "--cycles", "3", "-o", path})
                  .status,
              kDone);
    // The column is found by its name, whichever it is.
    std::string displacement;
    for (const std::string& line : Lines(FileContent(path))) {
      displacement += Cells(line)[2] + "," + Cells(line)[1] + "\n";
    }
    const Words words = {
        "tradeoff", "--path",      directory.Write("displacement.csv", displacement).string(),
        "--sigma",  "1",           "--slip-force",
        "1",        "--tolerance", "1%"};
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, kDone) << outcome.err;
    return Lines(outcome.out);
  };
  const Words far = cheapest("1e-3");
  EXPECT_THAT(far, Contains(StartsWith("cheapest within 1 % of the peak force: spring, 1.5 ns")));
  EXPECT_THAT(far, Contains(StartsWith("and of the dissipated energy: mindlin by exact")));
  EXPECT_THAT(cheapest("1e6"),
              Contains(StartsWith("cheapest within 1 % of the peak force: coulomb")));
  EXPECT_THAT(cheapest("0.8"),
              Contains(HasSubstr("mindlin by exact, 8.2 ns/sample: nothing cheaper")));
}

TEST(Tradeoff, RefusesAToleranceThatIsNone) {
  for (const char* tolerance : {"0", "-1%", "200%", "much"}) {
    const Outcome outcome =
        RunCommand({"tradeoff", "--excitation", "micro", "--tolerance", tolerance});
    EXPECT_EQ(outcome.status, kBadInput);
    EXPECT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
  }
}

}  // namespace
}  // namespace mindahl::cli::tradeoff_commands_test
