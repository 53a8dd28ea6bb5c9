#include "io/number_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "io/message_text.h"

namespace mindahl::io {

namespace {

bool EqualsIgnoringCase(std::string_view text, std::string_view lower_case) {
  return std::ranges::equal(text, lower_case, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

// Lists the texts that spreadsheets write for a number that they could not compute.
constexpr std::array<std::string_view, 7> kErrorValues = {"#n/a",   "#value!", "#div/0!", "#ref!",
                                                          "#name?", "#num!",   "#null!"};

bool IsMissingValueMark(std::string_view text) {
  constexpr std::array<std::string_view, 6> kMarks = {"nan", "inf", "infinity",
                                                      "na",  "n/a", "null"};
  const auto is_mark = [&](std::string_view mark) { return EqualsIgnoringCase(text, mark); };
  return std::ranges::any_of(kMarks, is_mark) || std::ranges::any_of(kErrorValues, is_mark);
}

NumberCell ReadWithPoint(std::string_view unsigned_text, bool negative) {
  NumberCell cell{.kind = NumberCell::Kind::kBroken};
  const char* const begin = unsigned_text.data();
  const char* const end = begin + unsigned_text.size();
  double magnitude = 0.0;
  const auto [stop, error] = std::from_chars(begin, end, magnitude);
  if (stop != end) return cell;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say on which side; only a negative exponent can make a number too small.
    const bool too_small = unsigned_text.find("e-") != std::string_view::npos ||
                           unsigned_text.find("E-") != std::string_view::npos;
    if (!too_small) return {.kind = NumberCell::Kind::kTooLarge};
    magnitude = 0.0;
  } else if (error != std::errc{}) {
    return cell;
  }
  cell.kind = NumberCell::Kind::kNumber;
  cell.value = negative ? -magnitude : magnitude;
  return cell;
}

}  // namespace

bool BeginsWithErrorValue(std::string_view text) {
  return std::ranges::any_of(kErrorValues, [&](std::string_view value) {
    if (text.size() < value.size() || !EqualsIgnoringCase(text.substr(0, value.size()), value)) {
      return false;
    }
    // A cell ends here; "#N/Available" is a comment.
    return text.size() == value.size() ||
           std::string_view(" \t\r\n,;\"").find(text[value.size()]) != std::string_view::npos;
  });
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

NumberCell ReadNumber(std::string_view cell, bool decimal_comma) {
  std::string_view text = Trimmed(cell);
  if (text.empty()) return {.kind = NumberCell::Kind::kEmpty};
  const bool negative = text.front() == '-';
  if (negative || text.front() == '+') text.remove_prefix(1);

  const bool starts_as_number =
      !text.empty() &&
      (IsDigit(text[0]) || (text[0] == '.' && text.size() > 1 && IsDigit(text[1])));
  if (!starts_as_number) {
    const bool missing = IsMissingValueMark(text);
    return {.kind = missing ? NumberCell::Kind::kBroken : NumberCell::Kind::kText};
  }

  const std::size_t comma = decimal_comma ? text.find(',') : std::string_view::npos;
  if (comma == std::string_view::npos) {
    NumberCell number = ReadWithPoint(text, negative);
    if (text.find('.') != std::string_view::npos) number.decimal_mark = '.';
    return number;
  }
  const bool between_digits = comma > 0 && comma + 1 < text.size() && IsDigit(text[comma + 1]);
  if (!between_digits || text.find('.') != std::string_view::npos) {
    return {.kind = NumberCell::Kind::kBroken};
  }
  std::string with_point(text);
  with_point[comma] = '.';
  NumberCell number = ReadWithPoint(with_point, negative);
  number.decimal_mark = ',';
  return number;
}

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

namespace {

/// True for a word: what is meant as a number, "--1", as a missing one, "#N/A" and "null", or as a
/// formula, "=1+1", is none.
bool IsWord(std::string_view cell) {
  constexpr std::array<std::string_view, 4> kMissing = {"null", "NULL", "None", "NA"};
  const std::string_view text = Trimmed(cell);
  const auto first = static_cast<unsigned char>(text.front());
  return (std::isalpha(first) != 0 || first >= 0x80) &&
         std::ranges::find(kMissing, text) == kMissing.end();
}

}  // namespace

bool BeginsFooter(const CsvRow& row, bool decimal_comma) {
  for (std::size_t cell = 0; cell < row.size(); ++cell) {
    const NumberCell::Kind kind = ReadNumber(row[cell], decimal_comma).kind;
    if (kind != NumberCell::Kind::kEmpty) {
      return kind == NumberCell::Kind::kText && IsWord(row[cell]);
    }
  }
  return false;
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
