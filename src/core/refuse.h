#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl {

/// Throws an InputError, or the Error that is named, with the formatted text.
template <typename Error = InputError, typename... Parts>
[[noreturn]] void Refuse(fmt::format_string<Parts...> text, Parts&&... parts) {
  throw Error(fmt::format(text, std::forward<Parts>(parts)...));
}

/// Returns `value` rounded to double.
/// @throws InvalidArgument where it exceeds the largest double
inline double Representable(std::string_view quantity, long double value) {
  if (!(std::abs(value) <= static_cast<long double>(std::numeric_limits<double>::max()))) {
    ThrowInvalid(quantity,
                 value > 0 ? std::numeric_limits<double>::infinity()
                           : -std::numeric_limits<double>::infinity(),
                 "must be within the range of double, 1.8e308: use larger units");
  }
  return static_cast<double>(value);
}

/// Returns "'mindin' is unknown: must be one of dahl, mindlin": of a word that is none of the names
/// that it may be.
template <typename Names>
std::string UnknownAmong(std::string_view word, const Names& names) {
  return fmt::format("'{}' is unknown: must be one of {}", word, fmt::join(names, ", "));
}

}  // namespace mindahl
