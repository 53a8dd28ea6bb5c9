#pragma once

#include <optional>
#include <string_view>

namespace mindahl::io {

/// Reads times of day, with or without a date, one after the other, as seconds [s] since midnight
/// of the first one's day: "12:11:14.596 PM", "04/29/2022 12:11:14", "2022-04-29T12:11:14,5Z".
/// A date of slashes is month/day/year unless its first number is above 12, or above 31, a year; of
/// dots or hyphens it is day.month.year, likewise. Without a date, a time that is 12 h or more
/// before the last one is of the next day. Zones are not looked at.
class ClockReader {
 public:
  /// Returns the time; empty for what is no such time.
  std::optional<double> Read(std::string_view cell);

 private:
  std::optional<long> first_day_;
  long day_ = 0;  // of times without a date
  double last_ = 0.0;
};

}  // namespace mindahl::io
