#pragma once

#include <cmath>
#include <string_view>

#include "mindahl/core/error.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::models {

[[nodiscard]] inline bool IsWithinReach(double displacement) {
  return std::abs(displacement) <= kLargestPathDisplacement;
}

/// @throws InvalidArgument unless the displacement can be part of a path
inline void RequireWithinReach(std::string_view quantity, double displacement) {
  if (!IsWithinReach(displacement)) {
    ThrowInvalid(quantity, displacement, "must be finite and within +-1e307 m");
  }
}

}  // namespace mindahl::models
