#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>

#ifndef __cpp_lib_to_chars
#include <fast_float/fast_float.h>

#include <cmath>
#endif

namespace mindahl {

/// Reads a number as std::from_chars does. libc++ reads floating point from version 20 on; before,
/// fast_float (Debian's libfast-float-dev) does.
template <typename Value>
std::from_chars_result FromChars(const char* begin, const char* end, Value& value) {
#ifdef __cpp_lib_to_chars
  return std::from_chars(begin, end, value);
#else
  if constexpr (std::is_floating_point_v<Value>) {
    const auto [stop, error] = fast_float::from_chars(begin, end, value);
    // It makes infinity of digits that are too large; the word starts with a letter.
    const char* const digits = begin + (begin != end && *begin == '-' ? 1 : 0);
    const bool is_too_large = digits != end && *digits < 'A' && std::isinf(value);
    return {stop, error == std::errc() && is_too_large ? std::errc::result_out_of_range : error};
  } else {
    return std::from_chars(begin, end, value);
  }
#endif
}

/// Returns the number that a whole text is; empty where it is none, or beyond what the type holds.
template <typename Value>
std::optional<Value> NumberIn(std::string_view text) {
  Value value{};
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  const auto [stop, error] = FromChars(begin, end, value);
  return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

}  // namespace mindahl
