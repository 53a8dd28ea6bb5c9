#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// Could a column hold numbers whose mark separates thousands, as "1.234" of 1234? All then lie
/// within ±1000 as they were read, with three decimals at most and none of them below 1.
bool MayHaveThousands(std::span<const double> values);

/// The first cell whose mark separates thousands beyond doubt: every cell is a whole number below
/// 1000, or has one to three digits, the mark and three more, both are there, and the column is
/// smoother, by a factor of two in the squares of its steps over its range, when the mark is left
/// out. (999, 1.000, 1.001 is; 1, 1.125, 1.25 is not.)
/// @param cells  of one column, without blanks around them
std::optional<std::size_t> FindThousands(std::span<const std::string_view> cells);

/// True if all cells are one to three digits, not a 0, a mark and three more digits, so that
/// nothing distinguishes a decimal mark from one that separates thousands.
/// @param cells  likewise
bool AreAllGrouped(std::span<const std::string_view> cells);

/// Reads times of day, with or without a date, one after the other, as seconds [s] since midnight
/// of the first one's day: "12:11:14.596 PM", "04/29/2022 12:11:14", "2022-04-29T12:11:14,5Z".
/// A date of slashes is month/day/year unless its first number is above 12, or above 31, a year; of
/// dots or hyphens it is day.month.year, likewise. Without a date, a time that is 12 h or more
/// before the last one is of the next day. Zones are not looked at.
class ClockReader {
 public:
  /// Returns the time; empty for what is no such time.
  std::optional<double> Read(std::string_view cell);

 private:
  std::optional<long> first_day_;
  long day_ = 0;  // of times without a date
  double last_ = 0.0;
};

/// Reads the numbers of some columns from lines of text, a row a line: what ParseCsvTable() reads
/// there, but that a quoted cell cannot go on in the next line. A plain line, of numbers without
/// quotation marks, is read without a cell being copied; any other is cut up by the tokenizer.
class NumberRowReader {
 public:
  /// @param columns  of the table; a row may lack those behind the last one that is wanted
  /// @param wanted   from 0, each once
  /// @param clock    of these, the one that holds times of day, as ClockReader reads them
  NumberRowReader(Delimiter delimiter, std::size_t columns, std::vector<std::size_t> wanted,
                  std::optional<std::size_t> clock = std::nullopt);

  enum class Row {
    kNumbers,
    kNone,    ///< blank, of delimiters alone, or a comment
    kBroken,  ///< see fault()
  };

  /// @param line    without its end
  /// @param number  of the line in its file, for messages
  /// @param values  written, in the order of `wanted`; of a row of numbers only
  Row Read(std::string_view line, std::size_t number, std::span<double> values);

  /// True if the last broken row begins with a text.
  [[nodiscard]] bool may_be_footer() const { return may_be_footer_; }
  /// Describes the fault of the last broken row, and its cell, from 0.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] std::size_t fault_column() const { return fault_column_; }

 private:
  bool ReadPlain(std::string_view line, std::size_t number, std::span<double> values);
  Row ReadAny(std::string_view line, std::size_t number, std::span<double> values);
  Row Break(std::size_t column, std::string fault);

  Delimiter delimiter_;
  std::vector<std::size_t> wanted_;
  std::optional<std::size_t> clock_;
  ClockReader times_;
  bool may_be_footer_ = false;
  std::size_t last_wanted_ = 0;
  std::vector<int> slots_;  // of each column, in the values; -1 where it is not wanted
  char mark_ = '\0';        // the decimal mark, once one was seen
  std::size_t mark_line_ = 0;
  CsvRow row_;
  std::string fault_;
  std::size_t fault_column_ = 0;
};

}  // namespace mindahl::io
