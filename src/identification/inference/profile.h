#pragma once

#include <cstddef>
#include <optional>

#include "identification/inference/estimates.h"
#include "identification/solve/search.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/models/branch_law.h"

/// Intervals by the likelihood, where the parabola of its maximum is wrong.
///
/// Far from gross slip a loop depends on σ and α/Tc, and weakly on the rest (docs/theory.md §10):
/// the likelihood is a long curved valley along which Tc, and α with it, may change many times at
/// little cost. The Jacobian at the best fit sees its floor there and no further. Beside a rig σ, α
/// and k share another, which bends towards the rigid rig.
namespace mindahl::identification {

/// Returns the ends of the interval of a parameter, where F of the best fit against those with it
/// held, the others fitted again, is the critical one, to a hundredth. A parameter's own bound is
/// an end; one that only the search has, or α's, leaves it open, and a slip force of twenty times
/// the largest force that is not clearly rejected.
Ends Profile(const FittedProblem& fitted, std::size_t parameter, const FitOptions& options,
             Solver& solver);

/// Returns the estimates with intervals by the likelihood of those of σ, α, Tc and a fitted rig of
/// which the parabola may be wrong: of a loop that hardly slips, at a bound, where they are badly
/// known, and where the likelihood at the parabola's ends is another one. A standard error that was
/// too small follows. Where Tc is open above, so is α.
ParameterEstimates WithProfiles(const FittedProblem& fitted, const FitResult& result,
                                const FitOptions& options, Solver& solver);

/// Returns Tc, a limit of which is no less than the force that the contact is seen to carry, unless
/// the fit is too poor to say.
ParameterEstimate KeepAboveCarriedForce(const Problem& problem, const FitResult& result);

/// Holds α = 1/3 in a compliant rig.
struct RigAlternative {
  double rig_stiffness = 0.0;  // [N/m]
  models::BranchLaw law;       // of the contact
};

/// A rig makes a loop more angular, as a smaller α does: where Mindlin's exponent lies above the
/// interval of α for a rigid rig, a compliant one may restore it.
/// @param shape  the estimate of α
/// @returns empty where 1/3 does not, a rig is there already, or none helps
std::optional<RigAlternative> TryRig(const FittedProblem& fitted, ThinnedRecords& thin,
                                     const ParameterEstimate& shape, const FitOptions& options,
                                     Solver& solver);

/// Includes in the intervals of σ, α and Tc those that they have in a compliant rig: the record
/// does not distinguish the two. A contact far stiffer than the rig is Jenkins' element again: the
/// same curve, no other α.
ParameterEstimates IncludeRig(const RigAlternative& rig, const Thresholds& thresholds,
                              ParameterEstimates parameters);

}  // namespace mindahl::identification
