#include "io/cell_fault.h"

#include <fmt/format.h>

#include <string_view>

#include "io/message_text.h"
#include "io/number_cell.h"

namespace mindahl::io {

std::string DescribeCellFault(const CsvRow& row, std::size_t column, std::size_t columns,
                              Delimiter delimiter) {
  if (column >= row.size()) {
    return fmt::format("the row has {} cell{} of {}: complete it or remove it", row.size(),
                       row.size() == 1 ? "" : "s", columns);
  }
  const std::string_view text = row[column];
  switch (ReadNumber(text, delimiter != Delimiter::kComma).kind) {
    case NumberCell::Kind::kEmpty:
      return "'' is not a number: fill in the cell or remove the row";
    case NumberCell::Kind::kTooLarge:
      return fmt::format("'{}' is too large: must be below 1.8e308", ForMessage(text));
    default:
      return fmt::format("'{}' is not a number: write it like -1.5e-3, or remove the row",
                         ForMessage(text));
  }
}

std::string DescribeExtraCell(const CsvRow& row, std::size_t columns, std::size_t& column) {
  for (column = columns; column < row.size(); ++column) {
    if (Trimmed(row[column]).empty()) continue;
    return fmt::format("'{}' is one cell too many: the table has {} column{}",
                       ForMessage(row[column]), columns, columns == 1 ? "" : "s");
  }
  return "";
}

std::string DescribeSecondMark(std::string_view cell, char mark, std::size_t first_line,
                               char first_mark) {
  return fmt::format("'{}' has the decimal mark '{}' and line {} has '{}': use one throughout",
                     ForMessage(cell), mark, first_line, first_mark);
}

}  // namespace mindahl::io
