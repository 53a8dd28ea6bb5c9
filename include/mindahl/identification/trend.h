#pragma once

#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/facts.h"

namespace mindahl::identification {

/// True if a trend over the cycles is beyond their scatter, and large enough to matter: |slope|
/// over the mean [a cycle] above `trend_size`, and p below `trend_chance`.
/// @param mean  of the fact, in its unit
bool IsWorthSaying(const loop::Trend& trend, double mean, const Thresholds& thresholds = {});

}  // namespace mindahl::identification
