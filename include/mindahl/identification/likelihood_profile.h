#pragma once

#include <array>
#include <string>
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

/// Joint confidence region of two parameters, all others fitted again at every point of its
/// boundary: 2 ln Λ = 2·F(2, ν), against the noise that the intervals have. It does not include
/// the model discrepancy.
struct ConfidenceRegion {
  std::array<std::string, 2> parameters;        ///< by name
  std::vector<std::array<double, 2>> boundary;  ///< [their units], once around the best fit
  /// True if the likelihood reaches the critical value in every direction, or α = 0 before it.
  bool closed = true;

  /// True if a point [their units] lies within the boundary.
  [[nodiscard]] bool Contains(double first, double second) const;
};

}  // namespace mindahl::identification
