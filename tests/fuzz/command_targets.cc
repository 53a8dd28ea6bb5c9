#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "cli/app.h"
#include "core/text.h"
#include "fuzz/bytes.h"
#include "fuzz/memory_file.h"
#include "support/histories.h"

namespace mindahl::fuzz {
namespace {

using Words = std::vector<std::string>;

// Options that a run may have, parted by strokes.
constexpr std::string_view kOptionsOfBoth =
    " | --model mindlin | --model dahl | --model jenkins | --offsets off"
    " | --terms force_drift | --rig-stiffness 1e9 | --terms viscous | --terms lag"
    " | --loss huber | --loss tukey | --terms plateau_slope | --initial-state virgin"
    " | --force-sign same | --force-sign opposite | --reversal-gate 0 | --fix alpha=0.5"
    " | --terms auto | --force-noise 0.1";
constexpr std::string_view kOptionsOfFit =
    "--compare | --rig-stiffness fit | --terms asymmetry | --trim off"
    " | --noise-in displacement | --initial-state steady | --normal-load 20"
    " | --terms slip_position_quadratic | --terms slip_speed | --terms ripple"
    " | --terms inertia | --fix speed_exponent=0.5 | --covariate 3=fit"
    " | --select cycles=2:3 | --terms backlash | --fix backlash=2e-7"
    " | --rig-stiffness 1e8+-3% | --rig-stiffness 1e8+-1e7 | --terms slip_trend"
    " | --terms backlash,slip_trend | --encoding utf-16le";
constexpr std::string_view kOptionsOfTrack =
    "--average 2 | --compliance 4e-11 | --broken-rows skip"
    " | --fix backlash=2e-7 | --rig-stiffness 1e8+-3% | --terms slip_trend"
    " | --encoding latin1";

/// Appends the options that a byte stands for.
void AddOptions(Words& words, std::string_view more, Bytes& bytes) {
  std::vector<std::string_view> choices = PartsOf(kOptionsOfBoth, '|');
  for (const std::string_view options : PartsOf(more, '|')) choices.push_back(options);
  std::istringstream chosen(std::string(choices[bytes.Byte() % choices.size()]));
  for (std::string word; chosen >> word;) words.push_back(word);
}

struct Outcome {
  int status = -1;
  std::string out;
  std::string messages;
};

/// Runs a command and requires what holds of every input.
Outcome Run(const Words& words) {
  std::vector<const char*> argv = {"mindahl"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::ostringstream out;
  std::ostringstream err;
  Outcome outcome;
  outcome.status = cli::Run(static_cast<int>(argv.size()), argv.data(), out, err);
  outcome.out = out.str();
  outcome.messages = err.str();
  if (outcome.status == cli::kInternalError) std::fputs(outcome.messages.c_str(), stderr);
  Require(outcome.status != cli::kInternalError, "no input is an internal error");
  Require(outcome.status != cli::kBadInput || outcome.out.empty(), "a refused run prints nothing");
  Require(outcome.status != cli::kBadInput || !outcome.messages.empty(), "a refusal is explained");
  return outcome;
}

void RequireNumbers(const std::string& json) {
  const nlohmann::json parsed = nlohmann::json::parse(json, nullptr, /*allow_exceptions=*/false);
  Require(!parsed.is_discarded(), "what is written as JSON is JSON");
  Require(parsed.contains("schema"), "a JSON names its schema");
}

void RequireFiniteCells(const std::string& table) {
  for (const std::string_view word : {",nan", ",-nan", ",inf", ",-inf"}) {
    Require(table.find(word) == std::string::npos, "a cell is finite or empty");
  }
}

/// Returns the text of a contact's record in m and N, ten samples a cycle, with a noise of 0.05 N.
std::string RecordOfCycles(int cycles) {
  std::vector<double> displacement = testing::Sine(cycles, 10, 0.1);
  displacement.pop_back();
  for (double& value : displacement) value *= 2e-6;
  const std::vector<double> force =
      testing::Respond(testing::Model("mindlin"), {5e7, 1.0 / 3.0, 60.0}, displacement);
  std::string text = "displacement [m],force [N]\n";
  for (std::size_t i = 0; i < force.size(); ++i) {
    text += fmt::format("{},{}\n", displacement[i],
                        force[i] + 0.01 * (static_cast<double>(7 * i % 11) - 5));
  }
  return text;
}

struct TrackedTest {
  MemoryFile record{RecordOfCycles(140)};
  std::string table;

  TrackedTest() {
    const MemoryFile output("");
    Require(
        Run({"track", record.name(), "--output", output.name(), "--threads", "1", "--overwrite"})
                .status == cli::kDone,
        "the test of resuming can be tracked");
    table = output.Content();
  }
};

/// Returns a row of the table without the energy of all cycles up to it: the sum has also what
/// somebody changed.
std::string WithoutTotal(std::string_view whole) {
  std::string row(whole);
  const std::size_t end = row.rfind(',', row.rfind(',') - 1);
  const std::size_t begin = row.rfind(',', end - 1);
  if (end != std::string::npos && begin < end) row.erase(begin, end - begin);
  return row;
}

}  // namespace

void FitRecords(Input input) {
  Bytes bytes(input);
  Words words = {"fit", "", "--json", "-"};
  AddOptions(words, kOptionsOfFit, bytes);
  AddOptions(words, kOptionsOfFit, bytes);
  const MemoryFile record(bytes.Text());
  words[1] = record.name();
  const Outcome outcome = Run(words);
  if (outcome.status == cli::kBadInput) return;
  RequireNumbers(outcome.out);
}

void TrackRecords(Input input) {
  Bytes bytes(input);
  const MemoryFile output("");
  Words words = {"track", "",       "--output", output.name(), "--overwrite", "--threads",
                 "1",     "--json", "-"};
  AddOptions(words, kOptionsOfTrack, bytes);
  AddOptions(words, kOptionsOfTrack, bytes);
  const MemoryFile record(bytes.Text());
  words[1] = record.name();
  const Outcome outcome = Run(words);
  RequireFiniteCells(output.Content());
  if (outcome.status == cli::kBadInput) return;
  RequireNumbers(outcome.out);
}

void ResumeTables(Input input) {
  static const TrackedTest test;
  Bytes bytes(input);
  std::string table = test.table;
  if (bytes.Byte() % 8 == 0) {
    table = bytes.Text();
  } else {
    while (!bytes.empty() && !table.empty()) {
      const std::size_t place = bytes.Number(3) % table.size();
      switch (bytes.Byte() % 4) {
        case 0:
          table[place] = static_cast<char>(bytes.Byte());
          break;
        case 1:
          table.erase(place, 1U + bytes.Byte());
          break;
        case 2:
          table.insert(place, 1, static_cast<char>(bytes.Byte()));
          break;
        default:
          table.resize(place);
      }
    }
  }
  const MemoryFile output(table);
  const Outcome outcome =
      Run({"track", test.record.name(), "--output", output.name(), "--threads", "1", "--resume"});
  if (outcome.status == cli::kBadInput) {
    Require(output.Content() == table, "a table that is refused is left alone");
  } else {
    // A value that somebody changed above the last batch is kept as it is.
    const std::string content = output.Content();
    const std::vector<std::string_view> lines = PartsOf(content, '\n');
    const std::vector<std::string_view> before = PartsOf(table, '\n');
    const std::vector<std::string_view> undisturbed = PartsOf(test.table, '\n');
    Require(lines.size() == undisturbed.size(), "a table that is gone on with becomes as long");
    for (std::size_t i = 0; i < lines.size(); ++i) {
      Require(WithoutTotal(lines[i]) == WithoutTotal(undisturbed[i]) ||
                  (i < before.size() && lines[i] == before[i]),
              "a table that is gone on with becomes the undisturbed");
    }
  }
}

}  // namespace mindahl::fuzz
