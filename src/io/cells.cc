#include "io/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <optional>
#include <system_error>
#include <vector>

#include "core/text.h"
#include "io/source.h"

namespace mindahl::io {
namespace {

/// The texts that spreadsheets write for a number that they could not compute, and other marks.
constexpr std::array<std::string_view, 19> kMissingMarks = {
    "#n/a", "#value!", "#div/0!",   "#ref!", "#name?", "#num!", "#null!", "nan", "-nan", "+nan",
    "na",   "n/a",     "-nan(ind)", "null",  "none",   "-",     "--",     "---", "."};

bool IsMissingMark(std::string_view text) {
  if (IsDigit(text.front()) || (text.size() > 1 && IsDigit(text[1]))) return false;
  return std::ranges::find(kMissingMarks, LowerCase(text)) != kMissingMarks.end();
}

/// Returns the start [s] of a day, "2024-03-05", since 1970; 0 where the order of its parts is not
/// certain.
std::optional<double> ReadDate(std::string_view text) {
  const std::size_t sign = text.find_first_of("-./");
  if (sign == text.npos) return std::nullopt;
  const std::vector<std::string_view> parts = PartsOf(text, text[sign]);
  if (parts.size() != 3) return std::nullopt;
  const auto year = NumberIn<int>(parts[0]);
  const auto month = NumberIn<unsigned>(parts[1]);
  const auto day = NumberIn<unsigned>(parts[2]);
  if (!year || !month || !day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(*month),
                                         std::chrono::day(*day)};
  if (*year < 1970 || !date.ok()) return 0.0;
  return kDay * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// Returns the seconds of "10:11:12.5" since midnight, or those of a date before it and of it.
std::optional<double> ReadClock(std::string_view text) {
  double midnight = 0.0;
  if (const std::size_t end = text.find_first_of("T "); end != text.npos) {
    const std::optional<double> date = ReadDate(text.substr(0, end));
    if (!date) return std::nullopt;
    midnight = *date;
    text = Trimmed(text.substr(end + 1));
  }
  // The zone behind it is the same in all rows.
  std::string plain(text.substr(0, text.find_first_of("Z+")));
  std::ranges::replace(plain, ',', '.');
  const std::vector<std::string_view> parts = PartsOf(plain, ':');
  if (parts.size() != 3) return std::nullopt;
  const auto hour = NumberIn<unsigned>(parts[0]);
  const auto minute = NumberIn<unsigned>(parts[1]);
  const auto second = NumberIn<double>(parts[2]);  // to 60 in one that leaps
  if (!hour || !minute || !second || *hour > 23 || *minute > 59) return std::nullopt;
  if (!(*second >= 0 && *second < 61)) return std::nullopt;
  return midnight + 3600.0 * *hour + 60.0 * *minute + *second;
}

}  // namespace

std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
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
    const char* last = end;
    while (last != at_ && (last[-1] == ' ' || last[-1] == '\t' || last[-1] == '\r')) --last;
    const std::string_view cell(at_, static_cast<std::size_t>(last - at_));
    GoBehind(end);
    return cell;
  }
  unescaped_.clear();
  for (++end; end != end_; ++end) {
    if (*end == '"') {
      if (end + 1 == end_ || end[1] != '"') break;
      ++end;
    }
    unescaped_ += *end;
  }
  is_open_ = end == end_;
  has_next_ = !is_open_;
  if (is_open_) return unescaped_.insert(0, 1, '"');
  for (++end; end != end_ && !IsDelimiter(*end); ++end) unescaped_ += *end;
  GoBehind(end);
  return Trimmed(unescaped_);
}

Cell ReadCell(std::string_view text, char delimiter) {
  if (text.empty() || IsMissingMark(text)) return {.kind = Cell::Kind::kMissing};
  std::string plain(text.substr(text.front() == '+' ? 1 : 0));
  std::size_t digit = text.front() == '-' ? 1 : 0;
  if (plain.size() > digit && plain[digit] == '.') ++digit;
  if (plain.size() <= digit || !IsDigit(plain[digit])) return {};
  char mark = plain.find('.') == plain.npos ? '\0' : '.';
  const std::size_t comma = mark == '\0' && delimiter != ',' ? plain.find(',') : plain.npos;
  if (comma < plain.size() - 1 && IsDigit(plain[comma + 1])) {
    plain[comma] = '.';
    mark = ',';
  }
  double value = 0.0;
  const char* const end = plain.data() + plain.size();
  const auto [stop, error] = std::from_chars(plain.data(), end, value);
  // from_chars does not say on which side a number is out of range; only a negative exponent can
  // make one too small.
  const bool is_beyond = error == std::errc::result_out_of_range;
  const bool is_small = is_beyond && LowerCase(plain).find("e-") != plain.npos;
  if (stop == end && (!is_beyond || is_small)) {
    return {.kind = Cell::Kind::kNumber, .value = is_small ? 0.0 : value, .decimal_mark = mark};
  }
  if (const std::optional<double> seconds = ReadClock(text)) {
    return {.kind = Cell::Kind::kClock, .value = *seconds};
  }
  return {.kind = ReadDate(text) ? Cell::Kind::kText : Cell::Kind::kBroken};
}

std::string DescribeCellFault(std::string_view text, Cell::Kind kind) {
  const std::string shown = ForMessage(text);
  if (kind == Cell::Kind::kMissing) {
    return fmt::format("'{}' is not a number: fill in the cell or remove the row", shown);
  }
  return fmt::format("'{}' is not a number: write it like -1.5e-3{}, or remove the row", shown,
                     text.find(',') == text.npos
                         ? ""
                         : ", without marks that separate thousands; where commas are "
                           "decimal marks, separate the columns by ';' or tabs");
}

}  // namespace mindahl::io
