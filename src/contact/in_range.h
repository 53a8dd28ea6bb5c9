#pragma once

#include <limits>
#include <string_view>

#include "mindahl/core/error.h"

namespace mindahl::contact {

/// Returns a positive result rounded to double.
/// @throws InvalidArgument where it is beyond the normal doubles
inline double InRange(std::string_view quantity, long double value) {
  using Limits = std::numeric_limits<double>;
  if (!(value >= static_cast<long double>(Limits::min()) &&
        value <= static_cast<long double>(Limits::max()))) {
    ThrowInvalid(quantity, value > 1 ? Limits::infinity() : 0.0,
                 "must be within the range of double, 2.2e-308 to 1.8e308");
  }
  return static_cast<double>(value);
}

}  // namespace mindahl::contact
