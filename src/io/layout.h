#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/io/csv_table.h"

namespace mindahl::io {

/// How a text is to be read as a table; csv_table.h states the rules by which it is found.
struct Layout {
  CsvTable header;  ///< the table without rows
  char delimiter = ',';
  // In some of the first rows, and in most, a column holds a number or what is meant as one.
  std::vector<bool> holds_numbers, mostly_numbers;
  std::size_t data_offset = 0;       ///< start of the first data row [bytes]
  std::size_t data_line = 0;         ///< its physical line
  std::string names_row, units_row;  // as they stand in the file: blocks of data repeat them

  [[nodiscard]] std::size_t columns() const { return header.columns.size(); }
  [[nodiscard]] bool has_decimal_comma() const { return delimiter != ','; }
};

/// Rows, the first of a file, in which the layout is looked for: at most so many are above the
/// data.
inline constexpr std::size_t kSampledRows = 1000;

/// @param text  the begin of a file, or all of it
/// @throws InputError when no row of numbers is found, or the row above the data is no header
Layout FindLayout(std::string_view text, const std::string& file);

}  // namespace mindahl::io
