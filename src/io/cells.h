#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// Returns the text without the blanks and tabs around it.
std::string_view Trimmed(std::string_view text);

/// Takes the first row off a text, without its end: a line, and those below it while a quotation
/// mark is open.
/// @param lines  increased by the number of lines taken
std::string_view TakeRow(std::string_view& text, std::size_t& lines);

/// True for a line that holds no row: blank, or a comment that begins with '#', where that is no
/// error value of a spreadsheet ("#N/A").
bool IsBlankOrComment(std::string_view line);

/// Separates the cells of a row; kBlanks is any run of spaces and tabs.
inline constexpr char kBlanks = ' ';

/// The cells of one row, valid as long as its text.
class Cells {
 public:
  /// Cuts a row into cells (RFC 4180), without the blanks around them. A trailing delimiter makes
  /// an empty cell.
  /// @returns false where a quotation mark is never closed
  bool Split(std::string_view row, char delimiter);

  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  std::string_view operator[](std::size_t cell) const { return cells_[cell]; }
  /// Returns the cell; empty where the row has none.
  [[nodiscard]] std::string_view At(std::size_t cell) const {
    return cell < cells_.size() ? cells_[cell] : std::string_view();
  }
  /// Returns the number of cells when the empty ones at the end are left out.
  [[nodiscard]] std::size_t FilledSize() const;

 private:
  std::vector<std::string_view> cells_;
  std::deque<std::string> unescaped_;  // of cells with a quotation mark within
};

/// Holds what a cell is read as.
struct Cell {
  enum class Kind {
    kNumber,
    kClock,     ///< a time of day, perhaps with a date: its value is in seconds
    kMissing,   ///< empty, or a mark of a missing number: "NaN", "n/a", "#DIV/0!", "-"
    kBroken,    ///< meant as a number and not one: "1.2.3", "5;2", "0x1F", "12:30"
    kTooLarge,  ///< "1e999": no finite double
    kText,
  };
  Kind kind = Kind::kText;
  double value =
      std::numeric_limits<double>::quiet_NaN();  ///< NaN unless it is a number or a clock
  char decimal_mark = '\0';                      ///< '.', ',' or none seen

  [[nodiscard]] bool is_number() const { return kind == Kind::kNumber || kind == Kind::kClock; }
};

/// Reads a whole cell as a plain decimal number: sign, digits, one decimal mark, exponent; or as a
/// time of day, "10:11:12.5", perhaps behind a date. "inf", hexadecimal and thousands separators
/// are no numbers; a magnitude below the smallest double is 0.
/// @param decimal_comma  "1,5" is 1.5; a decimal comma needs a digit on both sides
Cell ReadCell(std::string_view text, bool decimal_comma);

/// Describes the fault of a cell that should hold a number, and the remedy.
std::string DescribeCellFault(std::string_view text, Cell::Kind kind);

}  // namespace mindahl::io
