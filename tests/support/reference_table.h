#pragma once

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#ifndef MINDAHL_SOURCE_DIR
#error "MINDAHL_SOURCE_DIR must name the source root"
#endif

namespace mindahl::testing {

/// A line of a table of tests/data, split at the commas.
using TableLine = std::vector<std::string>;

/// The lines of tests/data/`name` that are neither comments nor blank.
inline std::vector<TableLine> ReadTable(const std::string& name) {
  const std::string path = MINDAHL_SOURCE_DIR "/tests/data/" + name;
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path);
  std::vector<TableLine> lines;
  for (std::string text; std::getline(in, text);) {
    if (text.empty() || text.front() == '#') continue;
    TableLine line;
    std::size_t begin = 0;
    for (std::size_t comma = text.find(','); comma != std::string::npos;
         comma = text.find(',', begin)) {
      line.push_back(text.substr(begin, comma - begin));
      begin = comma + 1;
    }
    line.push_back(text.substr(begin));
    lines.push_back(line);
  }
  return lines;
}

/// An input of a table, exact.
inline double ToDouble(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

/// A result of a table, to the 64 bits that comparing doubles needs.
inline long double ToLongDouble(const std::string& text) {
  return std::strtold(text.c_str(), nullptr);
}

}  // namespace mindahl::testing
