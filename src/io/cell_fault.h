#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "io/csv_tokenizer.h"

namespace mindahl::io {

/// Describes the fault of a cell that should hold a number, and the remedy: "'1.2.3' is not a
/// number: write it …".
/// @param row      of a table of `columns` columns
/// @param column   from 0; the row may end before it
std::string DescribeCellFault(const CsvRow& row, std::size_t column, std::size_t columns,
                              Delimiter delimiter);

/// The first cell beyond the table's columns that holds something, described; "" where none does.
std::string DescribeExtraCell(const CsvRow& row, std::size_t columns, std::size_t& column);

/// States that a file uses two decimal marks.
std::string DescribeSecondMark(std::string_view cell, char mark, std::size_t first_line,
                               char first_mark);

}  // namespace mindahl::io
