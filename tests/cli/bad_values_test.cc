#include <map>

#include "cli/command_line.h"

// Every option that takes a number or a word, with values that break its rule.
namespace mindahl::cli::bad_values_test {
namespace {

const Words kNoNumber = {"text", "1:", "1,5", "nan", "inf", "1e999"};

/// A rule, and values that break it.
const Words kPositive = kNoNumber + Words{"-1", "0"};
const Words kNonNegative = kNoNumber + Words{"-1"};
const Words kWhole = kNoNumber + Words{"-1", "0", "1.5", "", "1e-400"};
const Words kWholeOrZero = kNoNumber + Words{"-1", "1.5", ""};
const Words kPoisson = kNoNumber + Words{"-1", "0.6", ""};
const Words kRadius = {"nan", "0", "text", "1:", "1,5", ""};
const Words kWord = kNoNumber + Words{"-1", "0", "", "auto,auto"};
const Words kAssignment = kNoNumber + Words{"-1", "", "sigma", "=1", "sigma=", "sigma=x"};

struct Rule {
  const char* command;
  Words options;
  Words broken;
};

const std::vector<Rule> kRules = {
    {"fit",
     {"--force-noise", "--normal-load", "--contact-radius", "--compliance", "--youngs-modulus-1",
      "--youngs-modulus-2", "--rig-stiffness"},
     kPositive},
    {"fit", {"--displacement-noise", "--reversal-gate"}, kNonNegative},
    {"fit", {"--poisson-1", "--poisson-2"}, kPoisson},
    {"fit", {"--radius-1", "--radius-2"}, kRadius},
    {"fit",
     {"--model", "--initial-state", "--force-sign", "--noise-in", "--offsets", "--loss", "--trim"},
     kNoNumber + Words{"-1", "0", ""}},
    {"fit", {"--fix", "--start"}, kAssignment},
    {"fit", {"--compare", "--details"}, {"5", "nan", "text"}},
    {"fit",
     {"--select"},
     {"nan", "text", "1:2", "cycles", "cycles=", "cycles=1", "time=2:1", "load=2:1", "cycles=2:1",
      "samples=0:1"}},
    {"simulate",
     {"--sigma", "--slip-force", "--lambda", "--cycles", "--frequency", "--normal-load",
      "--friction", "--youngs-modulus-1"},
     kPositive},
    {"simulate", {"--noise-force", "--noise-displacement"}, kNonNegative},
    {"simulate", {"--samples-per-cycle", "--steps"}, kWhole},
    {"simulate", {"--seed"}, kWholeOrZero},
    {"simulate", {"--waveform", "--model", "--method"}, kWord},
    {"convert", {"--sigma", "--slip-force", "--amplitude", "--tolerance"}, kPositive},
    {"convert", {"--from", "--to"}, kWord},
    {"plan", {"--sigma", "--slip-force", "--force-noise", "--amplitude"}, kPositive},
    {"plan", {"--displacement-noise"}, kNonNegative},
    {"plan", {"--samples-per-cycle"}, kWhole},
    {"plan", {"--want"}, kNoNumber + Words{"-1", "0", ""}},
    {"contact", {"--friction", "--normal-load", "--contact-radius", "--compliance"}, kPositive},
    {"track", {"--force-noise", "--normal-load"}, kPositive},
    {"track", {"--displacement-noise", "--reversal-gate"}, kNonNegative},
    {"track", {"--average", "--threads"}, kWhole},
    {"track", {"--broken-rows", "--model", "--loss"}, kNoNumber + Words{"-1", "0", ""}},
    {"track", {"--resume", "--overwrite"}, {"5", "nan", "text"}},
    {"track", {"--normal-load-column"}, {"[text]", "[nan]", "[N]", "9"}},
    {"batch", {"--threads"}, kWhole},
    {"batch", {"--normal-load", "--force-noise"}, kPositive},
    {"validate", {"--cases"}, kWhole},
    {"validate", {"--seed"}, kWholeOrZero},
    {"tradeoff", {"--sigma", "--slip-force", "--tolerance"}, kPositive},
};

/// Uses of the commands that would run.
const std::map<std::string, std::string> kUses = {
    {"fit", SampleRecord()},
    {"simulate", "--sigma 4e7 --slip-force 40 --lambda 1 -o #"},
    {"convert", "--sigma 4e7 --slip-force 40 --amplitude 1e-6 --to lugre"},
    {"plan", "--sigma 4e7 --slip-force 40 --force-noise 0.1"},
    {"contact", "--friction 0.3 --normal-load 50 --contact-radius 3e-4 --compliance 4e-11"},
    {"track", SampleRecord() + " --output #"},
    {"batch", SampleRecord() + " --output #"},
    {"validate", ""},
    {"tradeoff", ""}};

TEST(BadValues, OfEveryOptionAreRefusedInOneLineThatNamesIt) {
  std::size_t tried = 0;
  for (const Rule& rule : kRules) {
    for (const std::string& option : rule.options) {
      for (const std::string& value : rule.broken) {
        const TemporaryDirectory directory;
        Words words = kUses.at(rule.command);
        std::ranges::replace(words, "#", (directory.path() / "output").string());
        const auto given = std::ranges::find(words, option);
        if (given != words.end()) words.erase(given, given + 2);
        words.insert(words.begin(), rule.command);
        words.push_back(fmt::format("{}={}", option, value));
        ExpectRefused(words, option);
        EXPECT_EQ(directory.FileCount(), 0U);
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, 600U);
}

}  // namespace
}  // namespace mindahl::cli::bad_values_test
