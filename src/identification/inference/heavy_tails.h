#pragma once

#include <optional>
#include <span>

#include "identification/inference/evidence.h"
#include "identification/inference/irregularities.h"

namespace mindahl::identification {

/// Readings that are far off both their neighbours, more of them than noise of one width makes.
///   uᵢ = rᵢ − (rᵢ₋₁ + rᵢ₊₁)/2
/// is free of whatever is smooth along the loop. A reading is off where |uᵢ| is beyond six
/// deviations of the samples on which the force is as steep, by their median, and its neighbours'
/// are of the other sign: a corner of the residuals, or a step, is none.
/// @returns with the fraction of such readings as its size; empty where there is none
std::optional<IrregularityFit> FindHeavyTails(std::span<const FittedSample> samples,
                                              const Evidence& evidence);

}  // namespace mindahl::identification
