#pragma once

#include <cmath>
#include <limits>
#include <string_view>

#include "mindahl/core/error.h"

namespace mindahl::models {

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

}  // namespace mindahl::models
