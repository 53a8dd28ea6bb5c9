#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/app.h"

/// Runs the command line in process.
namespace mindahl::testing {

struct Outcome {
  int status = -1;
  std::string out;
  std::string err;

  /// Lines of stderr that are neither notes nor warnings: what went wrong.
  [[nodiscard]] std::vector<std::string> Errors() const {
    std::vector<std::string> errors;
    std::istringstream lines(err);
    for (std::string line; std::getline(lines, line);) {
      const bool remark = line.find(": note: ") != std::string::npos ||
                          line.find(": warning: ") != std::string::npos;
      if (!remark) errors.push_back(line);
    }
    return errors;
  }

  [[nodiscard]] nlohmann::json Json() const { return nlohmann::json::parse(out); }
};

inline Outcome RunCommand(std::vector<std::string> words) {
  words.insert(words.begin(), "mindahl");
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::ostringstream out;
  std::ostringstream err;
  Outcome outcome;
  outcome.status = cli::Run(static_cast<int>(argv.size()), argv.data(), out, err);
  outcome.out = out.str();
  outcome.err = err.str();
  return outcome;
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

inline std::string SampleRecord() {
  return std::string(MINDAHL_SOURCE_DIR) + "/data/mindlin_sphere_on_plane.csv";
}

/// Value of a parameter in the JSON of a fit.
inline double Value(const nlohmann::json& fit, const char* parameter) {
  return fit.at("parameters").at(parameter).at("value");
}

}  // namespace mindahl::testing
