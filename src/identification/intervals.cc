#include "identification/intervals.h"

#include <algorithm>
#include <cmath>

#include "mindahl/identification/terms.h"

namespace mindahl::identification {

namespace {

/// Opens an end that is no number.
void RequireFiniteEnd(std::optional<double>& end) {
  if (end && !std::isfinite(*end)) end.reset();
}

}  // namespace

void SetInterval(ParameterEstimate& estimate, IntervalPart part) {
  RequireFiniteEnd(part.lower);
  RequireFiniteEnd(part.upper);
  estimate.lower95 = part.lower;
  estimate.upper95 = part.upper;
  estimate.interval.assign(1, part);
}

void Include(ParameterEstimate& estimate, IntervalPart part) {
  if (estimate.interval.empty()) return;
  RequireFiniteEnd(part.lower);
  RequireFiniteEnd(part.upper);
  estimate.interval.push_back(part);
  const bool is_closed_below = estimate.lower95 && part.lower;
  const bool is_closed_above = estimate.upper95 && part.upper;
  estimate.lower95 =
      is_closed_below ? std::optional(std::min(*estimate.lower95, *part.lower)) : std::nullopt;
  estimate.upper95 =
      is_closed_above ? std::optional(std::max(*estimate.upper95, *part.upper)) : std::nullopt;
}

void RaiseLowerEnd(ParameterEstimate& estimate, IntervalSource source, double least) {
  if (!estimate.lower95 || *estimate.lower95 >= least) return;
  estimate.lower95 = least;
  estimate.interval.push_back({.source = source, .lower = least, .upper = estimate.upper95});
}

void OpenAbove(ParameterEstimate& estimate, IntervalSource source) {
  Include(estimate, {.source = source, .lower = estimate.lower95});
  estimate.standard_error.reset();
}

void WithdrawInterval(ParameterEstimate& estimate) {
  estimate.standard_error.reset();
  estimate.lower95.reset();
  estimate.upper95.reset();
  estimate.interval.clear();
}

bool TurnsWithMotion(const ParameterEstimate& estimate) {
  const Term* const term = TermOfParameter(estimate.name);
  return term != nullptr && term->turns_with_motion;
}

bool IsScaledByLoad(const FitResult& result) {
  return !result.records.empty() && result.WidestRecord().load_varies &&
         result.model->memory == models::Memory::kNone;
}

}  // namespace mindahl::identification
