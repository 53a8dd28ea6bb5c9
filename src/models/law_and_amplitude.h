#pragma once

#include "mindahl/core/error.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::models {

/// @throws InvalidArgument naming what is wrong of either
inline void RequireLawAndAmplitude(const BranchLaw& law, double amplitude) {
  Validate(law);
  RequireNonNegative("amplitude [m]", amplitude);
}

}  // namespace mindahl::models
