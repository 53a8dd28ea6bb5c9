#include "io/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <system_error>

#include "core/text.h"
#include "io/source.h"

namespace mindahl::io {
namespace {

constexpr bool IsDigit(char character) { return character >= '0' && character <= '9'; }

/// The texts that spreadsheets write for a number that they could not compute, and other marks.
constexpr std::array<std::string_view, 19> kMissingMarks = {
    "#n/a", "#value!", "#div/0!",   "#ref!", "#name?", "#num!", "#null!", "nan", "-nan", "+nan",
    "na",   "n/a",     "-nan(ind)", "null",  "none",   "-",     "--",     "---", "."};

bool IsMissingMark(std::string_view text) {
  if (IsDigit(text.front()) || (text.size() > 1 && IsDigit(text[1]))) return false;
  return std::ranges::find(kMissingMarks, LowerCase(text)) != kMissingMarks.end();
}

Cell ReadWithPoint(std::string_view digits, bool negative) {
  double magnitude = 0.0;
  const auto [stop, error] = FromChars(digits.data(), digits.data() + digits.size(), magnitude);
  if (stop != digits.data() + digits.size()) return {.kind = Cell::Kind::kBroken};
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say on which side; only a negative exponent can make a number too small.
    if (LowerCase(digits).find("e-") == std::string::npos) return {.kind = Cell::Kind::kTooLarge};
    magnitude = 0.0;
  }
  return {.kind = Cell::Kind::kNumber, .value = negative ? -magnitude : magnitude};
}

/// Takes three whole numbers with a sign between them off a text: "10:11:12".
/// @returns none, and leaves the text, where it does not begin with them
std::optional<std::array<int, 3>> TakeThree(std::string_view& text, char sign) {
  std::string_view rest = text;
  std::array<int, 3> numbers{};
  for (int& number : numbers) {
    if (&number != numbers.data()) {
      if (!rest.starts_with(sign)) return std::nullopt;
      rest.remove_prefix(1);
    }
    if (rest.empty() || !IsDigit(rest.front())) return std::nullopt;
    const char* const end = std::to_address(rest.end());
    const auto [stop, error] = FromChars(std::to_address(rest.begin()), end, number);
    if (error != std::errc()) return std::nullopt;
    rest = {stop, end};
  }
  text = rest;
  return numbers;
}

/// Takes the three numbers of a date off a text, in the order that they have: "05.03.24".
std::optional<std::array<int, 3>> TakeDate(std::string_view& text) {
  for (const char sign : {'-', '.', '/'}) {
    if (const auto numbers = TakeThree(text, sign)) return numbers;
  }
  return std::nullopt;
}

/// Returns the seconds of "10:11:12.5", with a date since 1970 or, where the order of its parts is
/// not certain, since midnight.
std::optional<double> ReadClock(std::string_view text) {
  double midnight = 0.0;
  if (const auto parts = TakeDate(text)) {
    if (!text.starts_with('T') && !text.starts_with(' ')) return std::nullopt;
    text = Trimmed(text.substr(1));
    const auto& [year, month, day] = *parts;
    const std::chrono::year_month_day date{std::chrono::year(year),
                                           std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    if (year >= 1970 && date.ok()) {
      midnight = kDay * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
    }
  }
  const auto clock = TakeThree(text, ':');
  if (!clock) return std::nullopt;
  const auto& [hour, minute, second] = *clock;
  if (hour > 23 || minute > 59 || second > 60) return std::nullopt;  // 60: a leap second
  double seconds = 3600.0 * hour + 60.0 * minute + second;
  if (!text.empty() && std::string_view(".,:").find(text.front()) != std::string_view::npos) {
    const std::string digits(text.substr(1, text.find_first_not_of("0123456789", 1) - 1));
    if (digits.empty()) return std::nullopt;
    seconds += *NumberIn<double>("0." + digits);
    text.remove_prefix(1 + digits.size());
  }
  // A zone is the same in all rows.
  const bool has_zone = text.starts_with('Z') || text.starts_with('+') || text.starts_with('-');
  return text.empty() || has_zone ? std::optional(midnight + seconds) : std::nullopt;
}

}  // namespace

std::string_view TakeRow(std::string_view& text, std::size_t& lines, bool has_quotes) {
  std::size_t end = std::min(text.find('\n'), text.size());
  ++lines;
  if (has_quotes && text.substr(0, end).find('"') != std::string_view::npos) {
    const auto is_open = [&](std::size_t to) {
      return std::ranges::count(text.substr(0, to), '"') % 2 != 0;
    };
    std::size_t last = end;
    std::size_t more = 0;
    for (; is_open(last) && last < text.size(); ++more) {
      last = std::min(text.find('\n', last + 1), text.size());
    }
    if (!is_open(last)) {  // else never closed: a fault of its first line
      end = last;
      lines += more;
    }
  }
  const std::string_view row = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return row.ends_with('\r') ? row.substr(0, row.size() - 1) : row;
}

bool IsBlankOrComment(std::string_view line) {
  line = Trimmed(line);
  if (line.empty() || line.front() != '#') return line.empty();
  return !IsMissingMark(line.substr(0, line.find_first_of(" \t\r,;\"")));
}

std::string_view CellCursor::Take() {
  at_ = SkipBlanks(at_);
  const char* end = at_;
  if (at_ == end_ || *at_ != '"') {
    while (end != end_ && !IsDelimiter(*end)) ++end;
    const std::string_view cell = Trimmed({at_, static_cast<std::size_t>(end - at_)});
    GoBehind(end);
    return cell;
  }
  unescaped_.clear();
  for (++end; end != end_; ++end) {
    if (*end == '"') {
      if (end + 1 == end_ || end[1] != '"') break;
      ++end;
    }
    unescaped_ += *end == '\n' || *end == '\r' ? ' ' : *end;
  }
  is_open_ = end == end_;
  has_next_ = !is_open_;
  if (is_open_) return {at_, static_cast<std::size_t>(end_ - at_)};
  for (++end; end != end_ && !IsDelimiter(*end); ++end) unescaped_ += *end;
  GoBehind(end);
  return Trimmed(unescaped_);
}

Cell ReadCell(std::string_view text, bool decimal_comma) {
  if (text.empty() || IsMissingMark(text)) return {.kind = Cell::Kind::kMissing};
  std::string_view digits = text;
  const bool negative = digits.front() == '-';
  if (negative || digits.front() == '+') digits.remove_prefix(1);
  const std::size_t first = digits.starts_with('.') ? 1 : 0;
  if (digits.size() <= first || !IsDigit(digits[first])) {
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
  std::string_view rest = text;
  const bool is_date = TakeDate(rest) && rest.empty();
  return {.kind = is_date ? Cell::Kind::kText : Cell::Kind::kBroken};
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
