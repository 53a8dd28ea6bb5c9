#pragma once

#include <cmath>
#include <string_view>

#include "core/refuse.h"
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

}  // namespace mindahl::models
