#pragma once

#include <optional>
#include <span>

#include "identification/inference/irregularities.h"

namespace mindahl::identification {

/// Drops of the force, against the motion, that recur while the contact slides: a sawtooth. Of the
/// steps between samples on the plateau those beyond five deviations are counted; noise, whatever
/// its tails, makes as many rises as drops. Teeth of fewer than four samples pass for noise.
/// @returns with the median drop as its size [units of the data]; empty where there is none
std::optional<IrregularityFit> FindStickSlip(std::span<const FittedSample> samples);

}  // namespace mindahl::identification
