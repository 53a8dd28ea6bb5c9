#include "mindahl/io/csv_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string_view>

#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

/// Quoted when it must be: RFC 4180 §2.6, and a '#' or blank that a reader would take for its own.
std::string HeaderCell(const std::string& name) {
  const bool plain = name.find_first_of(",;\"\r\n\t") == std::string::npos && !name.empty() &&
                     !name.starts_with('#') && name.front() != ' ' && name.back() != ' ';
  if (plain) return name;
  std::string quoted = "\"";
  for (const char character : name) {
    if (character == '"') quoted += '"';
    quoted += character;
  }
  return quoted + '"';
}

}  // namespace

std::string CsvText(const std::vector<CsvColumn>& columns) {
  if (columns.empty()) throw InvalidArgument("number of columns = 0 is invalid: must be >= 1");
  const std::size_t rows = columns.front().values.size();
  std::string text;
  for (const CsvColumn& column : columns) {
    RequireSameSize(columns.front().name, rows, column.name, column.values.size());
    if (!text.empty()) text += ',';
    text += HeaderCell(column.name);
  }
  text += '\n';
  auto out = std::back_inserter(text);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t index = 0; index < columns.size(); ++index) {
      const CsvColumn& column = columns[index];
      const double value = column.values[row];
      if (std::isinf(value)) {
        ThrowInvalid(fmt::format("{} of row {}", column.name, row + 1), value, "must be finite");
      }
      if (index > 0) text += ',';
      if (!std::isnan(value)) fmt::format_to(out, "{:.17g}", value);
    }
    text += '\n';
  }
  return text;
}

}  // namespace mindahl::io
