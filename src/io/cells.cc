#include "io/cells.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <optional>
#include <system_error>

#include "core/text.h"

namespace mindahl::io {
namespace {

constexpr double kDay = 86'400.0;  // [s]

/// The texts that spreadsheets write for a number that they could not compute, and other marks.
constexpr std::array<std::string_view, 19> kMissingMarks = {
    "#n/a", "#value!", "#div/0!",   "#ref!", "#name?", "#num!", "#null!", "nan", "-nan", "+nan",
    "na",   "n/a",     "-nan(ind)", "null",  "none",   "-",     "--",     "---", "."};

bool IsMissingMark(std::string_view text) {
  if (IsDigit(text.front()) || (text.size() > 1 && IsDigit(text[1]))) return false;
  return std::ranges::find(kMissingMarks, LowerCase(text)) != kMissingMarks.end();
}

/// Returns the seconds of "10:11:12.5" since midnight, behind "2024-03-05T" since 1970; of another
/// date, whose order is not certain, the time of day alone counts.
std::optional<double> ReadClock(std::string text) {
  std::ranges::replace(text, ',', '.');
  int year = 0, place = 0;
  unsigned month = 0, day = 0, hour = 0, minute = 0;
  double seconds = 0.0;
  std::sscanf(text.c_str(), "%4d-%2u-%2u%*1[T ]%n", &year, &month, &day, &place);
  if (place > 0 && year > 99) {
    const std::chrono::year_month_day of{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
    if (!of.ok()) return std::nullopt;
    seconds = kDay * static_cast<double>(std::chrono::sys_days(of).time_since_epoch().count());
  }
  text.erase(0, text.find_first_of("T ") + 1);
  text.resize(std::min(text.find_first_of("Z+"), text.size()));  // a zone is that of all rows
  place = 0;
  std::sscanf(text.c_str(), "%2u:%2u:%n", &hour, &minute, &place);
  const auto second =
      NumberIn<double>(std::string_view(text).substr(static_cast<std::size_t>(place)));
  // 60 in a minute that leaps.
  const bool is_time = place > 0 && std::max(hour, minute) <= 60 && second >= 0 && second < 61;
  if (!is_time) return std::nullopt;
  return seconds + 3600.0 * hour + 60.0 * minute + *second;
}

}  // namespace

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
    const std::string_view cell = Trimmed({at_, end});
    GoBehind(end);
    return cell;
  }
  unescaped_.clear();
  is_open_ = true;
  for (++end; end != end_ && (is_open_ || !IsDelimiter(*end)); ++end) {
    if (is_open_ && *end == '"') {
      is_open_ = end + 1 != end_ && end[1] == '"';
      if (!is_open_) continue;
      ++end;
    }
    unescaped_ += *end;
  }
  GoBehind(end);
  return is_open_ ? unescaped_.insert(0, 1, '"') : Trimmed(unescaped_);
}

Cell ReadCell(std::string_view text, char decimal_mark) {
  if (text.empty() || IsMissingMark(text)) return {.kind = Cell::Kind::kMissing};
  std::string plain(text.substr(text.front() == '+' ? 1 : 0));
  const auto with_point = [](char sign) { return sign == ',' ? '.' : sign == '.' ? ',' : sign; };
  if (decimal_mark == ',') std::ranges::transform(plain, plain.begin(), with_point);
  std::size_t digit = text.front() == '-' ? 1 : 0;
  if (plain.size() > digit && plain[digit] == '.') ++digit;
  if (plain.size() <= digit || !IsDigit(plain[digit])) return {};
  double value = 0.0;
  const char* const end = plain.data() + plain.size();
  const auto [stop, error] = std::from_chars(plain.data(), end, value);
  // from_chars does not say on which side a number is out of range: small by a negative exponent.
  const bool is_beyond = error == std::errc::result_out_of_range;
  const bool is_small = is_beyond && LowerCase(plain).find("e-") != plain.npos;
  if (stop == end && (!is_beyond || is_small)) {
    return {.kind = Cell::Kind::kNumber, .value = is_small ? 0.0 : value};
  }
  const auto seconds = plain.find(':') != plain.npos ? ReadClock(plain) : std::nullopt;
  if (seconds) return {.kind = Cell::Kind::kNumber, .value = *seconds, .is_clock = true};
  const bool is_date = std::ranges::count(text, '-') == 2 || std::ranges::count(text, '/') == 2;
  return {.kind = is_date ? Cell::Kind::kText : Cell::Kind::kBroken};
}

}  // namespace mindahl::io
