#pragma once

#include <optional>

#include "identification/inference/estimates.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

/// Includes a law that the record does not exclude in the intervals of σ, α and Tc: of σ and Tc the
/// whole interval times the ratio of the values, of one that is open the value. One far stiffer
/// than its rig is Jenkins' element, the same curve with no other α: it is left out.
void IncludeLaw(const models::BranchLaw& law, const models::SeriesSpring& rig,
                const Thresholds& thresholds, ParameterEstimates& parameters);

/// Includes Mindlin's contact in a compliant rig in the intervals of σ, α and Tc, where the record
/// does not distinguish it: a rig makes a loop more angular, as a smaller α does, so that where
/// Mindlin's exponent lies above the interval of α for a rigid rig a compliant one may restore it.
/// @param parameters  intervals so far
/// @returns `shape_or_rig`; empty where a rig does not restore 1/3 or is there already
std::optional<Finding> IncludeCompliantRig(const Estimates& fitted, const FitOptions& options,
                                           Solver& solver, ParameterEstimates& parameters);

}  // namespace mindahl::identification
