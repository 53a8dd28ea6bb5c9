#pragma once

#include <span>

#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// The verdict on each parameter, from estimates and findings alone: the worst that a finding which
/// names it calls for (Identifiability is in the order of precedence), whatever their order.
///
/// | precedence | from | verdict |
/// |---|---|---|
/// | 1 | an estimate without error or interval, and the findings model_inadequate, no_model_fits,
/// |   | energy_contradiction, undetermined_…, …_not_identifiable, shape_or_rig, unknown_past,
/// |   | few_places, loop_not_seen | not identifiable |
/// | 2 | slip_force_bounded_below, sigma_bounded_below, an interval open above | bounded below |
/// | 3 | slip_force_extrapolated | extrapolated |
/// | 4 | nothing of it | identifiable |
///
/// What the user holds fixed is identifiable. A finding that names no parameter changes none.
void Judge(std::span<ParameterEstimate> estimates, std::span<const Finding> findings);

/// Under a model that does not describe the record nothing of it is to be believed: takes back
/// errors, limits, tests, and what the findings would have one do to know its parameters better;
/// adds the finding model_inadequate. Before Judge().
void WithdrawInadequate(FitResult& result);

/// The verdict that a finding calls for on the parameters that it names.
/// @throws std::logic_error for a code that has no row
Identifiability VerdictOf(const Finding& finding);

}  // namespace mindahl::identification
