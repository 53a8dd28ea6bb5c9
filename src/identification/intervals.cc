#include "identification/intervals.h"

#include <algorithm>
#include <cmath>

namespace mindahl::identification {

namespace {

/// Opens an end that is no number.
void RequireFiniteEnd(std::optional<double>& end) {
  if (end && !std::isfinite(*end)) end.reset();
}

}  // namespace

void SetInterval(ParameterEstimate& estimate, Ends ends) {
  RequireFiniteEnd(ends.lower);
  RequireFiniteEnd(ends.upper);
  estimate.lower95 = ends.lower;
  estimate.upper95 = ends.upper;
}

void Include(ParameterEstimate& estimate, Ends ends) {
  RequireFiniteEnd(ends.lower);
  RequireFiniteEnd(ends.upper);
  const bool is_closed_below = estimate.lower95 && ends.lower;
  const bool is_closed_above = estimate.upper95 && ends.upper;
  estimate.lower95 =
      is_closed_below ? std::optional(std::min(*estimate.lower95, *ends.lower)) : std::nullopt;
  estimate.upper95 =
      is_closed_above ? std::optional(std::max(*estimate.upper95, *ends.upper)) : std::nullopt;
}

void WithdrawInterval(ParameterEstimate& estimate) {
  estimate.standard_error.reset();
  estimate.lower95.reset();
  estimate.upper95.reset();
}

}  // namespace mindahl::identification
