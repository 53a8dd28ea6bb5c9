#include "io/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <system_error>
#include <utility>

#include "core/from_chars.h"
#include "core/text.h"
#include "io/source.h"

namespace mindahl::io {
namespace {

constexpr bool IsDigit(char character) { return character >= '0' && character <= '9'; }

// Lists the texts that spreadsheets write for a number that they could not compute.
constexpr std::array<std::string_view, 7> kErrorValues = {"#n/a",   "#value!", "#div/0!", "#ref!",
                                                          "#name?", "#num!",   "#null!"};

bool IsMissingMark(std::string_view text) {
  constexpr std::array<std::string_view, 12> kMarks = {
      "nan", "-nan", "+nan", "-nan(ind)", "na", "n/a", "null", "none", "-", "--", "---", "."};
  if (IsDigit(text.front()) || (text.size() > 1 && IsDigit(text[1]))) return false;
  const std::string lower = LowerCase(text);
  return std::ranges::find(kMarks, lower) != kMarks.end() ||
         std::ranges::find(kErrorValues, lower) != kErrorValues.end();
}

Cell ReadWithPoint(std::string_view unsigned_text, bool negative) {
  Cell cell{.kind = Cell::Kind::kBroken};
  const char* const begin = unsigned_text.data();
  const char* const end = begin + unsigned_text.size();
  double magnitude = 0.0;
  const auto [stop, error] = FromChars(begin, end, magnitude);
  if (stop != end) return cell;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say on which side; only a negative exponent can make a number too small.
    const bool too_small = unsigned_text.find("e-") != std::string_view::npos ||
                           unsigned_text.find("E-") != std::string_view::npos;
    if (!too_small) return {.kind = Cell::Kind::kTooLarge};
    magnitude = 0.0;
  } else if (error != std::errc{}) {
    return cell;
  }
  cell.kind = Cell::Kind::kNumber;
  cell.value = negative ? -magnitude : magnitude;
  return cell;
}

/// Takes a whole number off a text; empty where it does not begin with one.
std::optional<int> TakeNumber(std::string_view& text) {
  int number = 0;
  if (text.empty() || !IsDigit(text.front())) return std::nullopt;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

bool TakeCharacter(std::string_view& text, char character) {
  if (!text.starts_with(character)) return false;
  text.remove_prefix(1);
  return true;
}

/// Takes a date, "2024-03-05" or "05.03.24", and what separates it from the time off a text.
/// @returns the seconds from 1970 until its midnight, where the year is first; else 0; empty where
///   the text begins with no date
std::optional<double> TakeDate(std::string_view& text) {
  constexpr double kDay = 86'400.0;
  std::string_view rest = text;
  std::array<int, 3> parts{};
  char separator = '\0';
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (k == 1) separator = rest.empty() ? '\0' : rest.front();
    if (k == 1 && std::string_view("/.-").find(separator) == std::string_view::npos) return {};
    if (k > 0 && !TakeCharacter(rest, separator)) return {};
    const std::optional<int> number = TakeNumber(rest);
    if (!number) return {};
    parts[k] = *number;
  }
  if (!TakeCharacter(rest, 'T') && !TakeCharacter(rest, ' ')) return {};
  text = Trimmed(rest);
  const std::chrono::year_month_day date{std::chrono::year(parts[0]),
                                         std::chrono::month(static_cast<unsigned>(parts[1])),
                                         std::chrono::day(static_cast<unsigned>(parts[2]))};
  if (parts[0] < 1970 || !date.ok()) return 0.0;
  return kDay * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// Returns the seconds of "10:11:12.5", with a date since 1970 or, where the order of its parts is
/// not certain, since midnight.
std::optional<double> ReadClock(std::string_view text) {
  const double midnight = TakeDate(text).value_or(0.0);
  const std::optional<int> hours = TakeNumber(text);
  if (!hours || *hours > 23 || !TakeCharacter(text, ':')) return std::nullopt;
  const std::optional<int> minutes = TakeNumber(text);
  if (!minutes || *minutes > 59 || !TakeCharacter(text, ':')) return std::nullopt;
  const std::optional<int> seconds = TakeNumber(text);
  if (!seconds || *seconds > 60) return std::nullopt;  // 60 in a leap second
  double fraction = 0.0;
  if (TakeCharacter(text, '.') || TakeCharacter(text, ',') || TakeCharacter(text, ':')) {
    const std::size_t size = std::min(text.find_first_not_of("0123456789"), text.size());
    const std::optional<double> read = NumberIn<double>("0." + std::string(text.substr(0, size)));
    if (!read || size == 0) return std::nullopt;
    fraction = *read;
    text.remove_prefix(size);
  }
  // A zone is the same in all rows.
  const bool has_zone = text.starts_with('Z') || text.starts_with('+') || text.starts_with('-');
  if (!text.empty() && !has_zone) return std::nullopt;
  return midnight + 3600.0 * *hours + 60.0 * *minutes + *seconds + fraction;
}

/// True for "2024-03-05" and "5.3.2024", which is no number but meant as none either.
bool IsDate(std::string_view text) {
  std::string with_blank(text);
  with_blank += ' ';
  std::string_view rest = with_blank;
  return TakeDate(rest).has_value() && rest.empty();
}

}  // namespace

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string_view TakeRow(std::string_view& text, std::size_t& lines) {
  std::size_t end = std::min(text.find('\n'), text.size());
  ++lines;
  const auto is_open = [&] { return std::ranges::count(text.substr(0, end), '"') % 2 != 0; };
  if (text.substr(0, end).find('"') != std::string_view::npos) {
    const std::size_t one = end;
    std::size_t more = 0;
    while (is_open() && end < text.size()) {
      end = std::min(text.find('\n', end + 1), text.size());
      ++more;
    }
    if (is_open()) {
      end = one;  // never closed: a fault of its first line
    } else {
      lines += more;
    }
  }
  const std::string_view row = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return row.ends_with('\r') ? row.substr(0, row.size() - 1) : row;
}

bool IsBlankOrComment(std::string_view line) {
  line = Trimmed(line);
  if (line.empty()) return true;
  if (line.front() != '#') return false;
  const std::string first = LowerCase(line.substr(0, line.find_first_of(" \t\r,;\"")));
  return std::ranges::find(kErrorValues, first) == kErrorValues.end();
}

bool Cells::Split(std::string_view row, char delimiter) {
  cells_.clear();
  unescaped_.clear();
  const bool by_blanks = delimiter == kBlanks;
  if (by_blanks) row = Trimmed(row);
  const auto ends_cell = [&](std::size_t at) {
    return at == row.size() || row[at] == delimiter || (by_blanks && row[at] == '\t');
  };
  for (std::size_t at = 0;; ++at) {
    while (at < row.size() && (row[at] == ' ' || row[at] == '\t') &&
           (by_blanks || !ends_cell(at))) {
      ++at;
    }
    std::size_t end = at;
    if (at < row.size() && row[at] == '"') {
      std::string text;
      for (++end; end < row.size(); ++end) {
        if (row[end] == '"') {
          if (end + 1 == row.size() || row[end + 1] != '"') break;
          ++end;
        }
        text += row[end] == '\n' || row[end] == '\r' ? ' ' : row[end];
      }
      if (end == row.size()) return false;
      for (++end; !ends_cell(end); ++end) text += row[end];
      unescaped_.push_back(std::move(text));
      cells_.push_back(Trimmed(unescaped_.back()));
    } else {
      while (!ends_cell(end)) ++end;
      cells_.push_back(Trimmed(row.substr(at, end - at)));
    }
    if (end == row.size()) break;
    at = end;
  }
  return true;
}

std::size_t Cells::FilledSize() const {
  std::size_t filled = size();
  while (filled > 0 && cells_[filled - 1].empty()) --filled;
  return filled;
}

Cell ReadCell(std::string_view text, bool decimal_comma) {
  if (text.empty() || IsMissingMark(text)) return {.kind = Cell::Kind::kMissing};
  std::string_view digits = text;
  const bool negative = digits.front() == '-';
  if (negative || digits.front() == '+') digits.remove_prefix(1);
  const bool starts_as_number =
      !digits.empty() &&
      (IsDigit(digits[0]) || (digits[0] == '.' && digits.size() > 1 && IsDigit(digits[1])));
  if (!starts_as_number) {
    const std::string lower = LowerCase(digits);
    const bool is_infinite = lower == "inf" || lower == "infinity";
    return {.kind = is_infinite ? Cell::Kind::kBroken : Cell::Kind::kText};
  }
  const std::size_t comma = decimal_comma ? digits.find(',') : std::string_view::npos;
  Cell cell{.kind = Cell::Kind::kBroken};
  if (comma == std::string_view::npos) {
    cell = ReadWithPoint(digits, negative);
    if (digits.find('.') != std::string_view::npos) cell.decimal_mark = '.';
  } else if (comma + 1 < digits.size() && IsDigit(digits[comma + 1]) &&
             digits.find('.') == std::string_view::npos) {
    std::string with_point(digits);
    with_point[comma] = '.';
    cell = ReadWithPoint(with_point, negative);
    cell.decimal_mark = ',';
  }
  if (cell.kind != Cell::Kind::kBroken) return cell;
  if (const std::optional<double> seconds = ReadClock(text)) {
    return {.kind = Cell::Kind::kClock, .value = *seconds};
  }
  return {.kind = IsDate(text) ? Cell::Kind::kText : Cell::Kind::kBroken};
}

std::string DescribeCellFault(std::string_view text, Cell::Kind kind) {
  if (kind == Cell::Kind::kTooLarge) {
    return fmt::format("'{}' is too large: must be below 1.8e308", ForMessage(text));
  }
  if (kind == Cell::Kind::kMissing) {
    return fmt::format("'{}' is not a number: fill in the cell or remove the row",
                       ForMessage(text));
  }
  const std::size_t comma = text.find(',');
  const bool groups = comma != std::string_view::npos && comma > 0 &&
                      text.find_first_not_of("0123456789,.+-eE") == std::string_view::npos;
  return fmt::format("'{}' is not a number: write it like -1.5e-3{}, or remove the row",
                     ForMessage(text),
                     groups ? ", without marks that separate thousands; where commas are decimal "
                              "marks, separate the columns by ';' or tabs"
                            : "");
}

}  // namespace mindahl::io
