#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mindahl {

/// A broken precondition: names the quantity, its unit, its value and the rule.
///   "slip force [N] = -3 is invalid: must be finite and > 0"
class InvalidArgument : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Reports a fault in the user's input (a file, an option) with its place and remedy.
///   "loop.csv:12:3: '1,2,3' is not a number: …"
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// @throws InvalidArgument "<quantity> = <value> is invalid: <rule>" always.
/// @param quantity  name with unit, e.g. "slip force [N]"
[[noreturn]] void ThrowInvalid(std::string_view quantity, double value, std::string_view rule);

/// Each throws InvalidArgument unless `value` is finite and, of the last two, > 0 and >= 0.
void RequireFinite(std::string_view quantity, double value);
void RequirePositive(std::string_view quantity, double value);
void RequireNonNegative(std::string_view quantity, double value);

/// @throws InvalidArgument unless the two sizes agree.
void RequireSameSize(std::string_view first, std::size_t first_size, std::string_view second,
                     std::size_t second_size);

}  // namespace mindahl
