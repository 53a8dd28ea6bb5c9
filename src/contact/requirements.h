#pragma once

#include <cmath>
#include <limits>
#include <string_view>

#include "mindahl/core/error.h"

namespace mindahl::contact {

/// @throws InvalidArgument unless −1 < ν <= 0.5, the bounds of a stable isotropic body.
inline void RequirePoissonRatio(std::string_view quantity, double poisson_ratio) {
  if (!(poisson_ratio > -1.0 && poisson_ratio <= 0.5)) {
    ThrowInvalid(quantity, poisson_ratio, "must be > -1 and <= 0.5");
  }
}

/// @throws InvalidArgument on 0 and on what is not a number; planes and seats pass.
inline void RequireSurfaceRadius(std::string_view quantity, double radius) {
  if (std::isnan(radius) || radius == 0.0) {
    ThrowInvalid(
        quantity, radius,
        "must be a number other than 0: infinite for a plane, negative for a concave seat");
  }
}

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
