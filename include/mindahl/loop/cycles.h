#pragma once

#include <cstddef>

namespace mindahl::loop {

/// Holds what is measured on a record before any model is fitted.
struct LoopMeasures {
  /// Complete cycles: half the swings between reversals, rounded down; the ways from the record's
  /// start and to its end count by their length, 0.02 cycles short of one is one.
  std::size_t cycles = 0;
  /// X [m]: half the distance between the mean upper and lower extremes of the main swings, those
  /// at least 0.95 times as wide as the widest
  double amplitude = 0.0;
  double centre = 0.0;  ///< [m]: midway between those extremes
  /// T* [N]: half the distance between the greatest and least force of the main swings: the mean at
  /// their ends, or, where the force peaks before it turns, the extreme of its mean over a
  /// twentieth of a swing (median over the swings of a direction), so that neither noise nor a
  /// spike makes it
  double peak_force = 0.0;
  double centre_force = 0.0;  ///< [N]: midway between those forces
};

}  // namespace mindahl::loop
