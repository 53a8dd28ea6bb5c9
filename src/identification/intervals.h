#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// Counts the fitted parameters, for criteria: those not held.
inline std::size_t CountFreeParameters(const FitResult& fit) {
  return static_cast<std::size_t>(
      std::ranges::count_if(fit.parameters, [](const ParameterEstimate& parameter) {
        return parameter.status != ParameterStatus::kFixed;
      }));
}

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

/// Raises the lower end to a value that the parameter cannot lie below, which is no more than its
/// estimate. Leaves an end that is open, and an estimate without an interval, as it is.
void RaiseLowerEnd(ParameterEstimate& estimate, double least);

/// Opens the interval above: there is no standard error then.
void OpenAbove(ParameterEstimate& estimate);

/// Takes back the interval and the standard error.
void WithdrawInterval(ParameterEstimate& estimate);

/// True of Dahl's own law under a load that varies: its force follows the load at once, so that
/// neither a peak nor a half gap of the measured force bounds Tc.
bool IsScaledByLoad(const FitResult& result);

}  // namespace mindahl::identification
