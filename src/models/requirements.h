#pragma once

#include <cmath>
#include <limits>
#include <string_view>

#include "mindahl/core/error.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::models {

/// @throws InvalidArgument naming what is wrong of either
inline void RequireLawAndAmplitude(const BranchLaw& law, double amplitude) {
  Validate(law);
  if (!(amplitude >= 0 && amplitude <= kLargestPathDisplacement)) {
    ThrowInvalid("amplitude [m]", amplitude, "must be >= 0 and <= 1e100 m");
  }
}

/// @throws InvalidArgument unless the displacement can be part of a path
inline void RequireWithinReach(std::string_view quantity, double displacement) {
  if (!(std::abs(displacement) <= kLargestPathDisplacement)) {
    ThrowInvalid(quantity, displacement, "must be finite and within +-1e100 m");
  }
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

}  // namespace mindahl::models
