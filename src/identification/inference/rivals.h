#pragma once

#include <optional>

#include "identification/inference/estimates.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

/// Holds a contact that the record does not exclude, though it is not the fitted one: in a rig, in
/// another initial state, in another valley of the likelihood.
struct Rival {
  models::BranchLaw law;
  double load_exponent = 1.0;
  models::SeriesSpring rig = {};  // that the fitted contact does not have
};

Rival RivalAt(const Parameters& parameters, std::span<const double> theta);

/// Includes a rival in the intervals of σ, α, Tc and the exponent of the load: of σ and Tc the
/// whole interval times the ratio of the values, of one that is open the value. One far stiffer
/// than its rig is Jenkins' element again, the same curve with no other α: it is left out.
ParameterEstimates IncludeRival(const Rival& rival, const Thresholds& thresholds,
                                ParameterEstimates parameters);

/// A rig makes a loop more angular, as a smaller α does: where Mindlin's exponent lies above the
/// interval of α for a rigid rig, a compliant one may restore it.
/// @param shape  the estimate of α
/// @returns empty where 1/3 does not, a rig is there already, or none helps
std::optional<Rival> TryRig(const Estimates& fitted, const ParameterEstimate& shape,
                            const FitOptions& options, Solver& solver);

}  // namespace mindahl::identification
