#pragma once

#include <optional>

#include "identification/solve/turning_points.h"
#include "mindahl/identification/fit_options.h"

namespace mindahl::identification {

/// Fits again with a free overshoot a reversal where the record shows it to be needed.
///
/// A linear step in all parameters says what overshoots would gain; where that is far beyond chance
/// (2 ln Λ on the effective samples of what it leaves, χ² on as many degrees of freedom as
/// reversals), they are fitted. The step is not taken where even the longest overshoots would be
/// lost in the noise.
/// @returns empty where they are not needed, or not better by Akaike's criterion
std::optional<TurningPointFit> FitTurningPointsIfNeeded(const Problem& problem,
                                                        const Solution& best,
                                                        const FitOptions& options,
                                                        Response& response);

}  // namespace mindahl::identification
