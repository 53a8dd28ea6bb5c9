#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/csv_tokenizer.h"

namespace mindahl::io {

/// Byte order mark with which some programs begin a file in UTF-8.
inline constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

/// Rows, the first of a file, in which the layout is looked for: at most so many are above the
/// data.
inline constexpr std::size_t kSampledRows = 1000;

/// How a text is to be read as a table; csv_table.h states the rules by which it is found.
struct CsvLayout {
  Delimiter delimiter = Delimiter::kComma;
  std::size_t columns = 0;
  std::size_t usual_columns = 0;   ///< number in most rows; some have more
  std::vector<std::string> names;  ///< one a column, or none
  std::vector<std::string> units;  ///< cells of the units row, one a column, or none
  std::size_t header_line = 0;     ///< line of the names, else of the units row; 0 without either
  std::size_t preamble_rows = 0;   ///< rows above the header
  std::size_t data_offset = 0;     ///< start of the first data row [bytes]
  std::size_t data_line = 0;       ///< its physical line
};

/// @throws InputError when no row of numbers is found, or the row above the data is no header.
CsvLayout FindCsvLayout(std::string_view text, const std::string& file);

/// @throws InputError: the quotation mark opened on `line` has no partner.
[[noreturn]] void ThrowOpenQuote(const std::string& file, std::size_t line);

}  // namespace mindahl::io
