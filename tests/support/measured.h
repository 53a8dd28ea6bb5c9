#pragma once

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

/// Columns of the measured records, which are other people's and stay where they are.
namespace mindahl::testing {

inline std::string MeasuredPath(const std::string& file) {
  const char* directory = std::getenv("MINDAHL_MEASURED_DIR");
  return (directory != nullptr ? std::string(directory)
                               : std::string(MINDAHL_SOURCE_DIR) + "/../shared/measured") +
         "/" + file;
}

/// The numeric rows of a measured file; rows that do not start with a number are skipped. nullopt
/// where the file is absent.
inline std::optional<std::vector<std::vector<double>>> ReadMeasured(const std::string& file,
                                                                    char separator) {
  std::ifstream in(MeasuredPath(file));
  if (!in) return std::nullopt;
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::vector<double> row;
    std::size_t begin = 0;
    while (begin <= line.size()) {
      char* end = nullptr;
      const double number = std::strtod(line.c_str() + begin, &end);
      if (end == line.c_str() + begin) break;
      row.push_back(number);
      const std::size_t next = line.find(separator, begin);
      if (next == std::string::npos) break;
      begin = next + 1;
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

inline std::vector<double> Column(const std::vector<std::vector<double>>& rows,
                                  std::size_t column) {
  std::vector<double> values;
  for (const auto& row : rows) {
    if (column < row.size()) values.push_back(row[column]);
  }
  return values;
}

}  // namespace mindahl::testing
