#pragma once

#include <optional>

#include "identification/solve/search.h"
#include "identification/solve/turning_points.h"
#include "mindahl/identification/fit_options.h"

namespace mindahl::identification {

/// Fits again with turning points between the samples where the record shows that to be better.
///
/// At first where the motion itself has them, by the samples about each reversal, without a
/// parameter more: if they may move one by more than `turning_point_shift` standard errors, unless
/// the record shows the outermost samples to be better. Then with a free overshoot a reversal. A
/// linear step in all parameters says what overshoots would gain; where that is far beyond chance
/// (2 ln Λ on the effective samples of what it leaves, χ² on as many degrees of freedom as
/// reversals), they are fitted. The step is not taken where even the longest overshoots would be
/// lost in the noise.
/// @returns empty where they are not needed, or not better by Akaike's criterion
std::optional<TurningPointFit> FitTurningPointsIfNeeded(const Problem& problem,
                                                        const Solution& best,
                                                        const FitOptions& options,
                                                        SearchBuffers& buffers);

}  // namespace mindahl::identification
