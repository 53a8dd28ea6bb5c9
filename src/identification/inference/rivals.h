#pragma once

#include <optional>

#include "identification/inference/estimates.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::identification {

/// Holds a contact that the record does not exclude, though it is not the fitted one: in a rig, in
/// another initial state, in another valley of the likelihood.
struct Rival {
  models::BranchLaw law;
  double load_exponent = 1.0;
};

Rival RivalAt(const Parameters& parameters, std::span<const double> theta);

/// Includes a rival in the intervals of σ, α, Tc and the exponent of the load: of σ and Tc the
/// whole interval times the ratio of the values, of one that is open the value.
ParameterEstimates IncludeRival(const Rival& rival, ParameterEstimates parameters);

/// Holds α = 1/3 in a compliant rig.
struct RigAlternative {
  double rig_stiffness = 0.0;  // [N/m]
  Rival contact;
};

/// A rig makes a loop more angular, as a smaller α does: where Mindlin's exponent lies above the
/// interval of α for a rigid rig, a compliant one may restore it.
/// @param shape  the estimate of α
/// @returns empty where 1/3 does not, a rig is there already, or none helps
std::optional<RigAlternative> TryRig(const Estimates& fitted, const ParameterEstimate& shape,
                                     const FitOptions& options, Solver& solver);

/// Includes the contact in the rig. One far stiffer than the rig is Jenkins' element again: the
/// same curve, no other α.
ParameterEstimates IncludeRig(const RigAlternative& rig, const Thresholds& thresholds,
                              ParameterEstimates parameters);

}  // namespace mindahl::identification
