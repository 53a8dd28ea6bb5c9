#pragma once

#include <charconv>
#include <type_traits>

#ifndef __cpp_lib_to_chars
#include <fast_float/fast_float.h>

#include <cmath>
#include <system_error>
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

}  // namespace mindahl
