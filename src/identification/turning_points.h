#pragma once

#include <optional>

#include "identification/force_residual.h"
#include "identification/parameter_layout.h"
#include "identification/solver.h"

namespace mindahl::identification {

/// A fit in which the turning points are free to lie beyond the outermost samples.
struct TurningPointFit {
  ParameterLayout layout;
  Solution solution;
};

/// Fits again with a free overshoot a reversal where the record shows it to be needed.
///
/// A record that is sampled coarsely misses the extremes of its motion; the branches that follow
/// then start in the wrong place, and no other parameter can mend that without a bias. A linear
/// step in all parameters says what overshoots would gain; where that is far beyond chance
/// (likelihood ratio on the effective samples of what it leaves, χ² on as many degrees of freedom
/// as reversals, at 1e-6), they are fitted.
/// @returns empty when they are not needed, or not better by Akaike's criterion
std::optional<TurningPointFit> FitTurningPoints(const ScaledRecords& data,
                                                const ForceResidual& residual,
                                                const ParameterLayout& layout, const Solution& best,
                                                const FitOptions& options);

}  // namespace mindahl::identification
