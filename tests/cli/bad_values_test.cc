#include <fmt/format.h>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// Every option that takes a number or a word, with values that break its rule; and records with
// every kind of broken cell, first, in the middle and last.
namespace mindahl::cli::bad_values_test {
namespace {

using Words = std::vector<std::string>;

const Words kNoNumber = {"text", "1:", "1,5", "nan", "inf", "1e999"};

Words And(Words values, const Words& more) {
  values.insert(values.end(), more.begin(), more.end());
  return values;
}

/// A rule, and values that break it.
const Words kPositive = And(kNoNumber, {"-1", "0"});
const Words kNonNegative = And(kNoNumber, {"-1"});
const Words kWhole = And(kNoNumber, {"-1", "0", "1.5", "", "0x10", "1e-400"});
const Words kWholeOrZero = And(kNoNumber, {"-1", "1.5", "", "0x10"});
const Words kPoisson = And(kNoNumber, {"-1", "0.6", ""});
const Words kRadius = {"nan", "0", "text", "1:", "1,5", ""};
const Words kWord = And(kNoNumber, {"-1", "0", "", "auto,auto"});
const Words kRange = And(kNoNumber, {"-1", "0", "2:1", "a:b", "1:2:3"});
const Words kAssignment = And(kNoNumber, {"-1", "", "sigma", "=1", "sigma=", "sigma=x"});

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
     And(kNoNumber, {"-1", "0", ""})},
    {"fit", {"--fix", "--start"}, kAssignment},
    {"fit", {"--join", "--compare", "--details"}, {"5", "nan", "text"}},
    {"fit",
     {"--select"},
     {"nan", "text", "1:2", "cycles", "cycles=", "cycles=1", "time=2:1", "load=2:1", "cycles=2:1",
      "samples=0:1"}},
    {"simulate",
     {"--sigma", "--slip-force", "--lambda", "--cycles", "--frequency", "--tolerance",
      "--normal-load", "--friction", "--youngs-modulus-1"},
     kPositive},
    {"simulate", {"--noise-force", "--noise-displacement"}, kNonNegative},
    {"simulate", {"--asymmetry"}, kNoNumber},
    {"simulate", {"--samples-per-cycle", "--steps"}, kWhole},
    {"simulate", {"--seed"}, kWholeOrZero},
    {"simulate", {"--waveform", "--model", "--method"}, kWord},
    {"convert", {"--sigma", "--slip-force", "--amplitude", "--tolerance"}, kPositive},
    {"convert", {"--from", "--to"}, kWord},
    {"plan", {"--sigma", "--slip-force", "--force-noise", "--amplitude"}, kPositive},
    {"plan", {"--displacement-noise"}, kNonNegative},
    {"plan", {"--samples-per-cycle"}, kWhole},
    {"plan", {"--initial-state", "--with", "--want"}, And(kNoNumber, {"-1", "0", ""})},
    {"contact", {"--friction", "--normal-load", "--contact-radius", "--compliance"}, kPositive},
    {"track", {"--force-noise", "--normal-load"}, kPositive},
    {"track", {"--displacement-noise", "--reversal-gate"}, kNonNegative},
    {"track", {"--average", "--every", "--threads"}, kWhole},
    {"track", {"--broken-rows", "--model", "--loss"}, And(kNoNumber, {"-1", "0", ""})},
    {"track", {"--resume", "--overwrite"}, {"5", "nan", "text"}},
    {"track", {"--normal-load-column"}, {"[text]", "[nan]", "[N]", "9"}},
    {"batch", {"--threads"}, kWhole},
    {"batch", {"--normal-load", "--force-noise"}, kPositive},
    {"validate", {"--cases"}, kWhole},
    {"validate", {"--seed"}, kWholeOrZero},
    {"tradeoff", {"--sigma", "--slip-force", "--excitation", "--tolerance"}, kPositive},
};

/// A use of the command that would run, without the option.
Words UseOf(const std::string& command, const std::string& option, const std::string& output) {
  const std::vector<std::pair<std::string, Words>> uses = {
      {"fit", {SampleRecord()}},
      {"simulate", {"--sigma", "4e7", "--slip-force", "40", "--lambda", "1", "-o", output}},
      {"convert", {"--sigma", "4e7", "--slip-force", "40", "--amplitude", "1e-6", "--to", "lugre"}},
      {"plan", {"--sigma", "4e7", "--slip-force", "40", "--force-noise", "0.1"}},
      {"contact",
       {"--friction", "0.3", "--normal-load", "50", "--contact-radius", "3e-4", "--compliance",
        "4e-11"}},
      {"track", {SampleRecord(), "--output", output}},
      {"batch", {SampleRecord(), "--output", output}},
      {"validate", {}},
      {"tradeoff", {}}};
  Words words = std::ranges::find(uses, command, &std::pair<std::string, Words>::first)->second;
  const auto given = std::ranges::find(words, option);
  if (given != words.end()) words.erase(given, given + 2);
  words.insert(words.begin(), command);
  return words;
}

TEST(BadValues, OfEveryOptionAreRefusedInOneLineThatNamesIt) {
  std::size_t tried = 0;
  for (const Rule& rule : kRules) {
    for (const std::string& option : rule.options) {
      for (const std::string& value : rule.broken) {
        SCOPED_TRACE(fmt::format("mindahl {} {}={}", rule.command, option, value));
        const TemporaryDirectory directory;
        Words words = UseOf(rule.command, option, (directory.path() / "output").string());
        words.push_back(fmt::format("{}={}", option, value));
        const Outcome outcome = RunCommand(words);
        EXPECT_EQ(outcome.status, kBadInput);
        ASSERT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
        EXPECT_THAT(outcome.Errors().front(), HasSubstr(option));
        EXPECT_THAT(outcome.out, IsEmpty());
        EXPECT_EQ(directory.FileCount(), 0U);
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, 600U);
}

constexpr std::size_t kRows = 60;

/// A triangle and its force, of which one row is another.
std::string RecordWith(std::size_t broken_row, const std::string& row) {
  std::string text = "x [m],F [N]\n";
  for (std::size_t i = 0; i < kRows; ++i) {
    const std::size_t phase = i % 20;
    const std::size_t x = phase < 10 ? phase : 20 - phase;
    text += i == broken_row ? row + "\n" : fmt::format("{}e-6,{}\n", x, phase < 10 ? x : x - 4);
  }
  return text;
}

TEST(BadCells, AreRefusedWithLineAndColumn) {
  const Words cells = {"text", "nan",        "inf",  "-inf",  "1e999", "0x1p3", "1e",
                       "--1",  "1.2.3",      "1 2",  "#N/A",  "#REF!", "null",  "NULL",
                       "1:30", "2024-01-01", "=1+1", "1e5e5", "+-1",   "1_000", "\x01"};
  std::size_t tried = 0;
  for (const std::string& cell : cells) {
    for (const std::size_t row : {std::size_t{20}, kRows / 2, kRows - 1}) {
      for (const std::size_t column : {1U, 2U}) {
        const TemporaryDirectory directory;
        const std::string record =
            directory.Write("r.csv", RecordWith(row, column == 1 ? cell + ",1" : "1e-6," + cell));
        SCOPED_TRACE(fmt::format("'{}' in row {}, column {}", cell, row, column));
        const std::string place = fmt::format("r.csv:{}:{}: ", row + 2, column);
        const Outcome fit =
            RunCommand({"fit", record, "--json", (directory.path() / "o.json").string()});
        EXPECT_EQ(fit.status, kBadInput);
        ASSERT_THAT(fit.Errors(), SizeIs(1)) << fit.err;
        EXPECT_THAT(fit.Errors().front(), HasSubstr(place));
        EXPECT_EQ(directory.FileCount(), 1U);
        const Outcome track =
            RunCommand({"track", record, "--output", (directory.path() / "t.csv").string()});
        EXPECT_EQ(track.status, kBadInput);
        ASSERT_THAT(track.Errors(), SizeIs(1)) << track.err;
        EXPECT_THAT(track.Errors().front(), HasSubstr(place));
        tried += 2;
      }
    }
  }
  EXPECT_GT(tried, 200U);
}

}  // namespace
}  // namespace mindahl::cli::bad_values_test
