#include "identification/intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace mindahl::identification {

namespace {
constexpr double kUnbounded = std::numeric_limits<double>::infinity();
}  // namespace

void SetInterval(ParameterEstimate& estimate, Ends ends) {
  const auto closed = [](double end) {
    return std::isfinite(end) ? std::optional(end) : std::nullopt;
  };
  estimate.lower95 = closed(ends.lower.value_or(-kUnbounded));
  estimate.upper95 = closed(ends.upper.value_or(kUnbounded));
}

void Include(ParameterEstimate& estimate, Ends ends) {
  // std::min and std::max return their first argument where it is NaN, and SetInterval() opens that
  // end.
  const double lower =
      std::min(ends.lower.value_or(-kUnbounded), estimate.lower95.value_or(-kUnbounded));
  const double upper =
      std::max(ends.upper.value_or(kUnbounded), estimate.upper95.value_or(kUnbounded));
  SetInterval(estimate, {.lower = lower, .upper = upper});
}

void WithdrawInterval(ParameterEstimate& estimate) {
  estimate.standard_error.reset();
  estimate.lower95.reset();
  estimate.upper95.reset();
}

}  // namespace mindahl::identification
