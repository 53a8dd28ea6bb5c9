#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

#include "io/csv_tokenizer.h"

namespace mindahl::io {

/// Holds the text of one cell, classified and read as a number.
struct NumberCell {
  enum class Kind {
    kNumber,
    kEmpty,
    kBroken,    ///< meant as a number and not one: "1.2.3", "5;2", "0x1F", "nan", "12:30"
    kTooLarge,  ///< "1e999": no finite double
    kText,
  };

  Kind kind = Kind::kText;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN unless kind is kNumber
  char decimal_mark = '\0';                                 ///< '.', ',' or none seen
};

/// Reads a whole cell, blanks around it aside, as a plain decimal number: sign, digits, one decimal
/// mark, exponent. "nan", "inf", hexadecimal and thousands separators are not numbers; a magnitude
/// below the smallest double is 0.
/// @param decimal_comma  "1,5" is 1.5; a decimal comma needs a digit on both sides
NumberCell ReadNumber(std::string_view cell, bool decimal_comma);

/// The text, from its first character on, begins with an error value of a spreadsheet: "#N/A",
/// "#DIV/0!". That is a broken number, where another '#' begins a comment.
bool BeginsWithErrorValue(std::string_view text);

/// True for the ten digits of ASCII.
constexpr bool IsDigit(char character) { return character >= '0' && character <= '9'; }

/// `text` without the blanks and tabs around it.
std::string_view Trimmed(std::string_view text);

/// Describes the fault of a cell that should hold a number, and the remedy: "'1.2.3' is not a
/// number: write it …".
/// @param row      of a table of `columns` columns
/// @param column   from 0; the row may end before it
std::string DescribeCellFault(const CsvRow& row, std::size_t column, std::size_t columns,
                              Delimiter delimiter);

/// True for a row that begins with a text, and not with a number or a mark of a missing one: at the
/// end of a file it is no data.
bool BeginsFooter(const CsvRow& row, bool decimal_comma);

/// The first cell beyond the table's columns that holds something, described; "" where none does.
std::string DescribeExtraCell(const CsvRow& row, std::size_t columns, std::size_t& column);

/// States that a file uses two decimal marks.
std::string DescribeSecondMark(std::string_view cell, char mark, std::size_t first_line,
                               char first_mark);

}  // namespace mindahl::io
