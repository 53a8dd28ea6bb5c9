#pragma once

#include <optional>

#include "identification/inference/estimates.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::identification {

/// Holds α = 1/3 in a compliant rig.
struct RigAlternative {
  double rig_stiffness = 0.0;  // [N/m]
  models::BranchLaw law;       // of the contact
  double load_exponent = 1.0;
};

/// A rig makes a loop more angular, as a smaller α does: where Mindlin's exponent lies above the
/// interval of α for a rigid rig, a compliant one may restore it.
/// @param shape  the estimate of α
/// @returns empty where 1/3 does not, a rig is there already, or none helps
std::optional<RigAlternative> TryRig(const FittedProblem& fitted, const ParameterEstimate& shape,
                                     const FitOptions& options, Solver& solver);

/// Includes in the intervals of σ, α, Tc and the exponent of the load those that they have in a
/// compliant rig: the record does not distinguish the two. A contact far stiffer than the rig is
/// Jenkins' element again: the same curve, no other α.
ParameterEstimates IncludeRig(const RigAlternative& rig, const Thresholds& thresholds,
                              ParameterEstimates parameters);

}  // namespace mindahl::identification
