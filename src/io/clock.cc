#include "io/clock.h"

#include <array>
#include <charconv>
#include <chrono>
#include <cstddef>

#include "io/number_cell.h"

namespace mindahl::io {
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

}  // namespace mindahl::io
