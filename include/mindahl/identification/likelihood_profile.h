#pragma once

#include <vector>

#include "mindahl/models/branch_law.h"

namespace mindahl::identification {

/// A law with its slip force held, whatever else is free fitted again.
struct ProfilePoint {
  models::BranchLaw law;
  /// F of the best fit against this one: (SS − SS_best)/s² over the effective samples, 0 of the
  /// best fit itself.
  double statistic = 0.0;
};

/// The likelihood along Tc, where a fit looked at it (docs/theory.md §10).
struct LikelihoodProfile {
  double critical = 0.0;             ///< F(1, ν) beyond which points are outside the 95 % interval
  std::vector<ProfilePoint> points;  ///< in order of slip force
};

}  // namespace mindahl::identification
