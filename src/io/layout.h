#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// How a text is to be read as a table; csv_table.h states the rules by which it is found.
struct Layout {
  char delimiter = ',';
  std::size_t columns = 0;
  std::vector<std::string> names;  ///< one a column, or none
  std::vector<std::string> units;  // of a units row, one a column, or none
  std::vector<bool>
      holds_numbers;  ///< some of the first rows have in the column what is meant as a number
  std::vector<bool> mostly_numbers;
  std::size_t header_line = 0;    ///< line of the names, else of the units row; 0 without either
  std::size_t preamble_rows = 0;  ///< rows above the header
  std::size_t data_offset = 0;    ///< start of the first data row [bytes]
  std::size_t data_line = 0;      ///< its physical line
  std::string names_row;          // as it stands in the file: blocks of data repeat it
  std::string units_row;
  double interval = 0.0;  ///< [s] between rows, where a LabVIEW header states it; else 0

  [[nodiscard]] bool has_decimal_comma() const { return delimiter != ','; }
};

/// Rows, the first of a file, in which the layout is looked for: at most so many are above the
/// data.
inline constexpr std::size_t kSampledRows = 1000;

/// @param text  the begin of a file, or all of it
/// @throws InputError when no row of numbers is found, or the row above the data is no header
Layout FindLayout(std::string_view text, const std::string& file);

}  // namespace mindahl::io
