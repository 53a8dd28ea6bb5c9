#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/app.h"
#include "io/temporary_directory.h"
#include "support/histories.h"
#include "support/prelude.h"

/// Runs the command line in process.
namespace mindahl::testing {

using nlohmann::json;

/// The words of a command line; a text alone is taken apart at its blanks.
struct Words : std::vector<std::string> {
  using std::vector<std::string>::vector;
  Words(const std::string& line) {
    std::istringstream stream(line);
    for (std::string word; stream >> word;) push_back(word);
  }
  Words(const char* line) : Words(std::string(line)) {}
};

inline Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

inline std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

inline std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

/// Returns the cells of a table of CSV by rows, its header first.
inline std::vector<std::vector<std::string>> Rows(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& line : Lines(text)) rows.push_back(Cells(line));
  return rows;
}

/// Returns the numbers of a table of CSV by rows, without its header.
inline std::vector<std::vector<double>> Numbers(const std::string& text) {
  std::vector<std::vector<double>> rows;
  for (const auto& cells : Rows(text.substr(text.find('\n') + 1))) {
    std::vector<double>& row = rows.emplace_back();
    for (const std::string& cell : cells) row.push_back(std::stod(cell));
  }
  return rows;
}

/// Returns the numbers of a column, counted from 0.
inline std::vector<double> Column(const std::string& text, std::size_t column) {
  std::vector<double> values;
  for (const std::vector<double>& row : Numbers(text)) values.push_back(row.at(column));
  return values;
}

struct Outcome {
  int status = -1;
  std::string out;
  std::string err;

  /// Lines of stderr that are neither notes nor warnings: what went wrong.
  [[nodiscard]] std::vector<std::string> Errors() const {
    std::vector<std::string> errors = Lines(err);
    std::erase_if(errors, [](const std::string& line) {
      return line.find(": note: ") != std::string::npos ||
             line.find(": warning: ") != std::string::npos;
    });
    return errors;
  }

  [[nodiscard]] json Json() const { return json::parse(out); }
};

/// @param printed  takes the standard output in place of the outcome's `out`
inline Outcome RunCommand(Words words, std::ostream* printed = nullptr) {
  words.insert(words.begin(), "mindahl");
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::ostringstream out;
  std::ostringstream err;
  Outcome outcome;
  outcome.status = cli::Run(static_cast<int>(argv.size()), argv.data(),
                            printed != nullptr ? *printed : out, err);
  outcome.out = out.str();
  outcome.err = err.str();
  return outcome;
}

/// Runs a command that succeeds.
inline Outcome Done(const Words& words) {
  Outcome outcome = RunCommand(words);
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  EXPECT_THAT(outcome.Errors(), IsEmpty());
  return outcome;
}

/// The JSON of a command that succeeds.
inline json JsonOf(const Words& words) { return Done(words + "--json -").Json(); }

/// Expects that a command is refused in one line that has a text, and prints nothing.
inline void ExpectRefused(const Words& words, const std::string& text) {
  SCOPED_TRACE(fmt::format("mindahl {}", fmt::join(words, " ")));
  const Outcome outcome = RunCommand(words);
  EXPECT_EQ(outcome.status, cli::kBadInput);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.Errors(), ElementsAre(AllOf(StartsWith("mindahl"), HasSubstr(text))));
}

inline std::string SampleRecord() { return MINDAHL_SOURCE_DIR "/data/mindlin_sphere_on_plane.csv"; }

/// Value of a parameter in the JSON of a fit.
inline double Value(const json& fit, const char* parameter) {
  return fit.at("parameters").at(parameter).at("value");
}

/// A contact of Mindlin's, which slips as a whole from δc = 3Tc/(2σ) = 1.5 µm on.
inline constexpr models::BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
inline const Words kMindlinOptions = "--sigma 4e7 --slip-force 40";

inline void ExpectMindlin(const json& fit, double tolerance) {
  EXPECT_NEAR(Value(fit, "sigma") / kMindlin.tangential_stiffness, 1, tolerance);
  EXPECT_NEAR(Value(fit, "alpha"), kMindlin.shape_exponent, tolerance);
  EXPECT_NEAR(Value(fit, "slip_force") / kMindlin.slip_force, 1, tolerance);
}

/// Has files of its own.
class CommandTest : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (directory_.path() / name).string(); }
  std::string Write(const std::string& name, const std::string& text) const {
    return directory_.Write(name, text).string();
  }
  std::string Copy(const std::string& name) const {
    return Write(name, FileContent(SampleRecord()));
  }
  /// A file that `simulate` makes of the contact of kMindlin.
  std::string Simulated(const Words& options, const std::string& name = "loop.csv") const {
    Done("simulate" + (kMindlinOptions + options) + Words{"-o", Path(name)});
    return Path(name);
  }

  TemporaryDirectory directory_;
};

}  // namespace mindahl::testing
