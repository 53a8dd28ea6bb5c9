#pragma once

#include <optional>
#include <vector>

#include "identification/inference/estimates.h"
#include "identification/intervals.h"
#include "identification/problem/problem.h"
#include "identification/solve/search.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

inline constexpr double kMindlinExponent = 1.0 / 3;

/// α = 1/3 against the fitted α by the likelihood, which keeps to the valley along which α and Tc
/// run away together, where a standard error of α means little. Empty where α is held.
std::optional<MindlinTest> TestMindlin(const FittedProblem& fitted, const FitOptions& options,
                                       SearchBuffers& buffers);

/// Holds α = 1/3 in a compliant rig.
struct RigAlternative {
  double rig_stiffness = 0.0;         // [N/m]
  double tangential_stiffness = 0.0;  // σ of the contact [N/m]
};

/// A rig makes a loop more angular, as a smaller α does: where α = 1/3 is rejected for a rigid rig,
/// a compliant one may restore it.
/// @returns empty where α = 1/3 is not rejected, α is the larger one, a rig is there already, or
///   none helps
std::optional<RigAlternative> TryRig(const FittedProblem& fitted, ThinnedRecords& thin,
                                     const MindlinTest& test, const FitOptions& options,
                                     SearchBuffers& buffers);

/// Includes in the intervals of σ and α those that they have in a compliant rig: the record does
/// not distinguish the two. A contact far stiffer than the rig is Jenkins' element again: the same
/// curve, no other α.
ParameterEstimates IncludeRig(const RigAlternative& rig, const Thresholds& thresholds,
                              ParameterEstimates parameters);

/// True if Mindlin's exponent is rejected for a smaller one on a rigid rig, so that a compliant rig
/// may be the cause.
bool WantsRig(const Problem& problem, const Solution& best, const MindlinTest& test,
              const Thresholds& thresholds);

}  // namespace mindahl::identification
