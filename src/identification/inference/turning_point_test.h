#pragma once

#include <optional>

#include "identification/solve/search.h"
#include "identification/solve/turning_points.h"
#include "mindahl/identification/fit_options.h"

namespace mindahl::identification {

/// Fits again with turning points where the motion has them, by the samples about each reversal:
/// no parameter is spent on them.
/// @returns empty where they may move no parameter by more than `turning_point_shift` standard
///   errors, or the record shows its outermost samples to be better
std::optional<TurningPointFit> FitAtTurningPoints(const Problem& problem, const Solution& best,
                                                  const FitOptions& options,
                                                  SearchBuffers& buffers);

}  // namespace mindahl::identification
