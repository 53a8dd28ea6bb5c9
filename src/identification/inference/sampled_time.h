#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/problem/scaled_records.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {

/// Derivatives by time of what was sampled.

/// Samples that a derivative at one of them may look at: turning points that were put in between
/// have no time of their own.
struct Neighbours {
  std::vector<std::size_t> samples;        // that were measured
  std::vector<unsigned char> turns_after;  // of each: the motion turns there or before the next one
  std::vector<unsigned char> turned;       // of each: it turned between it and the one before
};

Neighbours NeighboursOf(const ScaledRecord& record);

/// When each sample was read, from the middle of its record, in a unit that all records share.
struct Clock {
  bool timed = true;  // else by sample
  double unit = 1.0;  // [s], or samples
  std::vector<std::vector<double>> time;
};

Clock ClockOf(const ScaledRecords& data, std::span<const Neighbours> neighbours);

/// True if at least a fifth of the readings of the displacement repeat the one before: it may be
/// read less often than the force, and what is missing of the motion is no white noise.
bool IsDisplacementHeld(const ScaledRecords& data, std::span<const Neighbours> neighbours);

/// Derivative by time, by differences to both sides.
/// @param within_strokes  never beyond a turn; a turn is the stroke's that ends there
void Derive(std::span<const double> values, std::span<const double> time,
            const Neighbours& neighbours, bool within_strokes, std::span<double> rate);

}  // namespace mindahl::identification
