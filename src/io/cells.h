#pragma once

#include <limits>
#include <string>
#include <string_view>

#include "core/text.h"

namespace mindahl::io {

constexpr bool IsDigit(char character) { return character >= '0' && character <= '9'; }
constexpr bool IsCapital(char character) { return character >= 'A' && character <= 'Z'; }
constexpr bool IsSmall(char character) { return character >= 'a' && character <= 'z'; }
/// True for a letter, and for any part of one that is not of ASCII.
constexpr bool IsLetter(char letter) {
  return IsCapital(letter) || IsSmall(letter) || static_cast<unsigned char>(letter) >= 0x80;
}

/// True for a line that holds no row: blank, or a comment that begins with '#', where that is no
/// error value of a spreadsheet ("#N/A").
bool IsBlankOrComment(std::string_view line);

/// Separates the cells of a row; kBlanks is any run of spaces and tabs.
inline constexpr char kBlanks = ' ';

/// Takes the cells off a row (RFC 4180) without blanks around them; a trailing delimiter makes an
/// empty cell.
class CellCursor {
 public:
  CellCursor(std::string_view row, char delimiter)
      : rest_(delimiter == kBlanks ? Trimmed(row) : row), delimiter_(delimiter) {}

  /// True if there is a further cell.
  [[nodiscard]] bool has_next() const { return has_next_; }
  /// True if a quotation mark is never closed; its cell is the rest of the row, with it.
  [[nodiscard]] bool is_open() const { return is_open_; }

  /// Takes the next cell; valid until another is taken.
  std::string_view Take();

 private:
  std::string_view rest_;
  char delimiter_;
  bool has_next_ = true;
  bool is_open_ = false;
  std::string unescaped_;
};

/// Holds what a cell is read as.
struct Cell {
  enum class Kind {
    kNumber,
    kMissing,  ///< empty, or a mark of a missing number: "NaN", "n/a", "#DIV/0!", "-"
    kBroken,   ///< meant as a number and not one: "1.2.3", "5;2", "0x1F", "1e999"
    kText,
  };
  Kind kind = Kind::kText;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN unless it is a number
  bool is_clock = false;  ///< a time of day [s], perhaps behind a date
};

/// Reads a whole cell as a plain decimal number: sign, digits, one decimal mark, exponent; or as a
/// time of day, "10:11:12.5", perhaps behind a date, of which that of ISO 8601 counts. "inf" and
/// hexadecimal are no numbers; a magnitude below the smallest double is 0.
Cell ReadCell(std::string_view text, char decimal_mark);

}  // namespace mindahl::io
