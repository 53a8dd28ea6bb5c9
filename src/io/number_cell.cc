#include "io/number_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/from_chars.h"
#include "io/csv_tokenizer.h"

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
  const auto [stop, error] = FromChars(begin, end, magnitude);
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

namespace {

constexpr double kThousand = 1000.0;

/// A whole number below 1000, or one with a mark before its last three digits.
struct Grouped {
  bool has_mark = false;
  double as_read = 0.0;       // the mark a decimal one
  double as_thousands = 0.0;  // the mark left out
};

std::optional<Grouped> ReadGrouped(std::string_view cell) {
  constexpr std::size_t kGroup = 3;
  const bool negative = cell.starts_with('-');
  if (negative || cell.starts_with('+')) cell.remove_prefix(1);
  const std::size_t mark = cell.find_first_of(".,");
  const std::string_view head = cell.substr(0, mark);
  const std::string_view tail =
      mark == std::string_view::npos ? std::string_view() : cell.substr(mark + 1);
  const auto is_digits = [](std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  };
  if (head.empty() || head.size() > kGroup || !is_digits(head) || !is_digits(tail)) {
    return std::nullopt;
  }
  const bool has_mark = mark != std::string_view::npos;
  if (has_mark && (tail.size() != kGroup || head.starts_with('0'))) return std::nullopt;
  int whole = 0;
  int group = 0;
  std::from_chars(head.data(), head.data() + head.size(), whole);
  std::from_chars(tail.data(), tail.data() + tail.size(), group);
  const double sign = negative ? -1.0 : 1.0;
  return Grouped{has_mark, sign * (whole + group / kThousand),
                 sign * (has_mark ? whole * kThousand + group : whole)};
}

/// Squares of the steps from value to value, over the range's.
double Roughness(std::span<const double> values) {
  const auto [least, greatest] = std::ranges::minmax(values);
  if (!(greatest > least)) return 0.0;
  double squares = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    squares += std::pow((values[i] - values[i - 1]) / (greatest - least), 2);
  }
  return squares;
}

}  // namespace

bool MayHaveThousands(std::span<const double> values) {
  constexpr double kRounding = 1e-6;
  return std::ranges::all_of(values, [](double value) {
    const double size = std::abs(value);
    if (!(size < kThousand)) return false;
    if (size == std::floor(size)) return true;
    return size >= 1 && std::abs(size * kThousand - std::round(size * kThousand)) < kRounding;
  });
}

std::optional<std::size_t> FindThousands(std::span<const std::string_view> cells) {
  constexpr double kSmoother = 2.0;
  std::optional<std::size_t> first;
  bool any_whole = false;
  std::vector<double> as_read;
  std::vector<double> as_thousands;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::optional<Grouped> grouped = ReadGrouped(cells[i]);
    if (!grouped) return std::nullopt;
    if (grouped->has_mark && !first) first = i;
    any_whole = any_whole || !grouped->has_mark;
    as_read.push_back(grouped->as_read);
    as_thousands.push_back(grouped->as_thousands);
  }
  if (!first || !any_whole) return std::nullopt;
  if (!(Roughness(as_read) > kSmoother * Roughness(as_thousands))) return std::nullopt;
  return first;
}

bool AreAllGrouped(std::span<const std::string_view> cells) {
  return std::ranges::all_of(cells, [](std::string_view cell) {
    const std::optional<Grouped> grouped = ReadGrouped(cell);
    return grouped && grouped->has_mark;
  });
}

namespace {

constexpr double kDay = 86'400.0;  // [s]

/// Takes a whole number off a text; empty where it does not begin with one.
std::optional<unsigned> TakeNumber(std::string_view& text) {
  unsigned number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end == text.data()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

/// Takes a date off a text, as a number of days; empty where it does not begin with one.
std::optional<long> TakeDate(std::string_view& text) {
  std::string_view rest = text;
  std::array<unsigned, 3> parts{};
  char separator = '\0';
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (k > 0) {
      const bool goes_on = !rest.empty() && (k == 1 || rest.front() == separator) &&
                           std::string_view("/.-").find(rest.front()) != std::string_view::npos;
      if (!goes_on) return std::nullopt;
      separator = rest.front();
      rest.remove_prefix(1);
    }
    const std::optional<unsigned> number = TakeNumber(rest);
    if (!number) return std::nullopt;
    parts[k] = *number;
  }
  auto [year, month, day] = parts;
  if (parts[0] <= 31) {  // the year is last
    constexpr unsigned kCentury = 2000;
    year = parts[2] < 100 ? kCentury + parts[2] : parts[2];
    const bool month_first = separator == '/' ? parts[0] <= 12 : parts[1] > 12;
    month = month_first ? parts[0] : parts[1];
    day = month_first ? parts[1] : parts[0];
  }
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(month), std::chrono::day(day)};
  if (!date.ok() || rest.empty() || (rest.front() != ' ' && rest.front() != 'T')) {
    return std::nullopt;
  }
  text = Trimmed(rest.substr(1));
  return std::chrono::sys_days(date).time_since_epoch().count();
}

/// Takes AM or PM off the end of a text: the hours to add to 12, 1, …, 11; empty where neither is.
std::optional<unsigned> TakeHalfDay(std::string_view& text) {
  if (text.size() < 3) return std::nullopt;
  const std::string_view word = text.substr(text.size() - 2);
  const bool is_pm = word == "PM" || word == "pm" || word == "Pm";
  if (!is_pm && word != "AM" && word != "am" && word != "Am") return std::nullopt;
  text = Trimmed(text.substr(0, text.size() - 2));
  return is_pm ? 12U : 0U;
}

/// Returns the seconds since midnight; empty for what is no time of day.
/// @param has_date  without one, a time has seconds or AM or PM: "12:30" may be minutes
std::optional<double> SecondsOf(std::string_view text, bool has_date) {
  const std::optional<unsigned> half_day = TakeHalfDay(text);
  const std::optional<unsigned> hours = TakeNumber(text);
  if (!hours || !text.starts_with(':')) return std::nullopt;
  text.remove_prefix(1);
  const std::optional<unsigned> minutes = TakeNumber(text);
  if (!minutes || *minutes > 59 || *hours > (half_day ? 12U : 23U)) return std::nullopt;
  const unsigned hour = half_day ? *hours % 12 + *half_day : *hours;
  const double until_minute = 3600.0 * hour + 60.0 * *minutes;
  if (!text.starts_with(':')) {
    if (!text.empty() || !(has_date || half_day)) return std::nullopt;
    return until_minute;
  }
  text.remove_prefix(1);
  const std::optional<unsigned> whole = TakeNumber(text);
  if (!whole || *whole > 60) return std::nullopt;  // 60 in a leap second
  double fraction = 0.0;
  if (!text.empty() && (text.front() == '.' || text.front() == ',' || text.front() == ':')) {
    text.remove_prefix(1);
    double place = 1.0;
    while (!text.empty() && IsDigit(text.front())) {
      fraction = 10 * fraction + (text.front() - '0');
      place *= 10;
      text.remove_prefix(1);
    }
    if (place == 1.0) return std::nullopt;
    fraction /= place;
  }
  const bool is_zone = text == "Z" || text.starts_with('+') || text.starts_with('-');
  if (!text.empty() && !(has_date && is_zone)) return std::nullopt;
  return until_minute + *whole + fraction;
}

}  // namespace

std::optional<double> ClockReader::Read(std::string_view cell) {
  cell = Trimmed(cell);
  const std::optional<long> date = TakeDate(cell);
  const std::optional<double> seconds = SecondsOf(cell, date.has_value());
  if (!seconds) return std::nullopt;
  if (!first_day_) first_day_ = date.value_or(0);
  if (date) {
    day_ = *date - *first_day_;
  } else if (static_cast<double>(day_) * kDay + *seconds <= last_ - kDay / 2) {
    ++day_;
  }
  last_ = static_cast<double>(day_) * kDay + *seconds;
  return last_;
}

namespace {

bool IsBlank(char character) { return character == ' ' || character == '\t'; }

const char* SkipBlanks(const char* at, const char* end) {
  while (at != end && IsBlank(*at)) ++at;
  return at;
}

/// Neither "nan" nor "inf", which from_chars takes too.
bool BeginsAsNumber(const char* at, const char* end) {
  if (at != end && *at == '-') ++at;
  return at != end && (IsDigit(*at) || *at == '.');
}

}  // namespace

NumberRowReader::NumberRowReader(Delimiter delimiter, std::size_t columns,
                                 std::vector<std::size_t> wanted, std::optional<std::size_t> clock)
    : delimiter_(delimiter), wanted_(std::move(wanted)), clock_(clock), slots_(columns, -1) {
  for (std::size_t k = 0; k < wanted_.size(); ++k) slots_[wanted_[k]] = static_cast<int>(k);
  for (const std::size_t column : wanted_) last_wanted_ = std::max(last_wanted_, column);
}

NumberRowReader::Row NumberRowReader::Read(std::string_view line, std::size_t number,
                                           std::span<double> values) {
  if (ReadPlain(line, number, values)) return Row::kNumbers;
  return ReadAny(line, number, values);
}

/// False where the line is not plain: then nothing is said of it.
bool NumberRowReader::ReadPlain(std::string_view line, std::size_t number,
                                std::span<double> values) {
  const bool by_blanks = delimiter_ == Delimiter::kBlanks;
  const bool comma_may_be_mark = delimiter_ != Delimiter::kComma;
  const bool may_be_padded = !by_blanks && delimiter_ != Delimiter::kTab;
  const auto delimiter = static_cast<char>(delimiter_);
  const char* at = line.data();
  const char* const end = at + line.size();
  if (line.empty() || std::memchr(at, '"', line.size()) != nullptr) return false;
  bool has_point = false;
  if (const char* const first = SkipBlanks(at, end); first == end || *first == '#') return false;
  if (by_blanks) at = SkipBlanks(at, end);
  for (std::size_t column = 0; column < slots_.size(); ++column) {
    if (column > 0) {  // at the delimiter that ends the cell before
      if (at == end) {
        if (column <= last_wanted_) return false;
        break;
      }
      at = by_blanks ? SkipBlanks(at, end) : at + 1;
    }
    if (slots_[column] < 0) {
      const char* next = at;
      while (next != end && (by_blanks ? !IsBlank(*next) : *next != delimiter)) ++next;
      if (next == at && by_blanks) return false;
      at = next;
      continue;
    }
    if (may_be_padded) at = SkipBlanks(at, end);
    if (!BeginsAsNumber(at, end)) return false;
    double value = 0.0;
    const auto [stop, error] = FromChars(at, end, value);
    if (error != std::errc()) return false;
    if (comma_may_be_mark && !has_point) {
      has_point = std::memchr(at, '.', static_cast<std::size_t>(stop - at)) != nullptr;
    }
    values[static_cast<std::size_t>(slots_[column])] = value;
    at = stop;
    if (may_be_padded) at = SkipBlanks(at, end);
    if (at != end && (by_blanks ? !IsBlank(*at) : *at != delimiter)) return false;
  }
  if (at != end && SkipBlanks(at + (by_blanks ? 0 : 1), end) != end) return false;
  if (has_point && mark_ != '.') {
    if (mark_ != '\0') return false;
    mark_ = '.';
    mark_line_ = number;
  }
  return true;
}

NumberRowReader::Row NumberRowReader::ReadAny(std::string_view line, std::size_t number,
                                              std::span<double> values) {
  CsvTokenizer tokenizer(line, delimiter_, 0, number);
  if (!tokenizer.Next(row_)) {
    if (!tokenizer.EndedInQuotes()) return Row::kNone;
    may_be_footer_ = false;
    return Break(0, "a quotation mark opened here is never closed");
  }
  const bool decimal_comma = delimiter_ != Delimiter::kComma;
  may_be_footer_ = BeginsFooter(row_, decimal_comma);
  std::size_t extra = 0;
  std::string fault = DescribeExtraCell(row_, slots_.size(), extra);
  if (!fault.empty()) return Break(extra, std::move(fault));
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const std::size_t column = wanted_[k];
    if (column == clock_ && column < row_.size()) {
      const std::optional<double> time = times_.Read(row_[column]);
      if (!time) {
        return Break(column, fmt::format("'{}' is not a time of day as in the rows above: write it "
                                         "like 14:05:06.789, or remove the row",
                                         ForMessage(row_[column])));
      }
      values[k] = *time;
      continue;
    }
    const NumberCell cell =
        column < row_.size() ? ReadNumber(row_[column], decimal_comma) : NumberCell{};
    if (cell.kind != NumberCell::Kind::kNumber) {
      return Break(column, DescribeCellFault(row_, column, slots_.size(), delimiter_));
    }
    values[k] = cell.value;
    if (!decimal_comma || cell.decimal_mark == '\0' || cell.decimal_mark == mark_) continue;
    if (mark_ != '\0') {
      return Break(column, DescribeSecondMark(row_[column], cell.decimal_mark, mark_line_, mark_));
    }
    mark_ = cell.decimal_mark;
    mark_line_ = number;
  }
  return Row::kNumbers;
}

NumberRowReader::Row NumberRowReader::Break(std::size_t column, std::string fault) {
  fault_column_ = column;
  fault_ = std::move(fault);
  return Row::kBroken;
}

}  // namespace mindahl::io
