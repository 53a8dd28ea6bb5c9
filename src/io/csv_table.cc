#include "mindahl/io/csv_table.h"

#include <fmt/format.h>

#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <iterator>

#include "mindahl/core/error.h"

namespace mindahl::io {

std::string CsvCell(const std::string& text) {
  const bool plain = text.find_first_of(",;\"\r\n\t") == std::string::npos && !text.empty() &&
                     !text.starts_with('#') && text.front() != ' ' && text.back() != ' ';
  return plain ? text : '"' + boost::replace_all_copy(text, "\"", "\"\"") + '"';
}

std::string CsvText(const std::vector<CsvColumn>& columns) {
  if (columns.empty()) throw InvalidArgument("number of columns = 0 is invalid: must be >= 1");
  const std::size_t rows = columns.front().values.size();
  std::string text;
  for (const CsvColumn& column : columns) {
    RequireSameSize(columns.front().name, rows, column.name, column.values.size());
    if (!text.empty()) text += ',';
    text += CsvCell(column.name);
  }
  text += '\n';
  for (std::size_t row = 0; row < rows; ++row) {
    for (const CsvColumn& column : columns) {
      const double value = column.values[row];
      if (std::isinf(value)) {
        ThrowInvalid(fmt::format("{} of row {}", column.name, row + 1), value, "must be finite");
      }
      if (&column != columns.data()) text += ',';
      if (!std::isnan(value)) fmt::format_to(std::back_inserter(text), "{:.17g}", value);
    }
    text += '\n';
  }
  return text;
}

}  // namespace mindahl::io
