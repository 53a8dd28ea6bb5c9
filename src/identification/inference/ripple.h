#pragma once

#include <optional>
#include <span>

#include "identification/inference/irregularities.h"

namespace mindahl::identification {

/// Looks for a periodic force where the contact slides, as a drive screw or a gear makes: of the
/// periods between four readings and a third of the plateau the one whose cosine and sine, one
/// pair for each direction, explain most of the residuals' deviation from a line over each stroke.
/// It is a ripple where a pair for each stroke explains hardly more (stick-slip has another phase
/// in each), and none of another period three times as much; it is fitted with its first three
/// harmonics.
/// @returns with the period as its size [units of the data]; empty where there is none
std::optional<IrregularityFit> FindRipple(std::span<const FittedSample> samples);

}  // namespace mindahl::identification
