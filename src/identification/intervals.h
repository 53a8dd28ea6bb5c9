#pragma once

#include <optional>
#include <vector>

#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// The one place where the interval of an estimate is written, the union of its parts.

using ParameterEstimates = std::vector<ParameterEstimate>;

/// Longest linear step of θ that an interval takes: beyond a factor of e³ it says only that little
/// is known.
inline constexpr double kFarthestStep = 3.0;

/// Ends of an interval, or of a part of one; empty where it is open.
struct Ends {
  std::optional<double> lower = {};
  std::optional<double> upper = {};
};

/// Begins the interval anew. An end that is not finite is open.
void SetInterval(ParameterEstimate& estimate, Ends ends);

/// Extends the interval by a part: an end that is open in either is open from then on. Leaves an
/// estimate without an interval, held or undetermined, as it is.
void Include(ParameterEstimate& estimate, Ends ends);

/// Takes back the interval and the standard error.
void WithdrawInterval(ParameterEstimate& estimate);

}  // namespace mindahl::identification
