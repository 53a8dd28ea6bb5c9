#pragma once

#include <charconv>
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
  CellCursor(std::string_view row, char delimiter) : delimiter_(delimiter) {
    if (delimiter == kBlanks) row = Trimmed(row);
    at_ = row.data();
    end_ = at_ + row.size();
  }

  /// True if there is a further cell.
  [[nodiscard]] bool has_next() const { return has_next_; }
  /// True if a quotation mark is never closed; its cell is the rest of the row, with it.
  [[nodiscard]] bool is_open() const { return is_open_; }

  /// Takes the next cell; valid until another is taken.
  std::string_view Take();

  /// Takes the next cell if it is a number with a decimal point and no sign of plus; returns false
  /// and takes nothing where it is none.
  bool TakeNumber(double& value) {
    const char* const begin = SkipBlanks(at_);
    const char* digits = begin;
    if (digits != end_ && *digits == '-') ++digits;
    if (digits != end_ && *digits == '.') ++digits;
    if (digits == end_ || *digits < '0' || *digits > '9') return false;  // nor "nan"
    const auto [stop, error] = std::from_chars(begin, end_, value);
    const char* const after = delimiter_ == kBlanks ? stop : SkipBlanks(stop);
    if (error != std::errc() || (after != end_ && !IsDelimiter(*after))) return false;
    GoBehind(after);
    return true;
  }

 private:
  [[nodiscard]] bool IsDelimiter(char character) const {
    return character == delimiter_ || (delimiter_ == kBlanks && character == '\t');
  }
  [[nodiscard]] const char* SkipBlanks(const char* at) const {
    while (at != end_ && (*at == ' ' || *at == '\r' || (*at == '\t' && delimiter_ != '\t'))) ++at;
    return at;
  }
  /// @param delimiter  at the end of a cell, or of the row
  void GoBehind(const char* delimiter) {
    has_next_ = delimiter != end_;
    at_ = !has_next_ ? end_ : delimiter_ == kBlanks ? SkipBlanks(delimiter) : delimiter + 1;
  }

  char delimiter_;
  const char* at_ = nullptr;
  const char* end_ = nullptr;
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
