#pragma once

#include <memory>
#include <span>

#include "identification/problem/problem.h"
#include "identification/solve/solver.h"

namespace mindahl::identification {

/// Puts the turning points of records beyond their outermost samples, by an overshoot each, next to
/// these.
///
/// A record that is sampled coarsely misses the extremes of its motion; the branches that follow
/// then start in the wrong place, and no other parameter can correct that without a bias.
/// @param overshoot  >= 0, one a reversal of all records
ScaledRecords PutInTurningPoints(const ScaledRecords& data, std::span<const double> overshoot);

/// Returns how far the motion turns beyond a reversal's sample, by the samples about it alone: >=
/// 0, at most the longer of the adjacent steps. It turns where the lines through the two samples
/// before and the two after meet if its velocity changes there and hardly next to it, as that of a
/// triangle does; else at the extremum of the polynomial through the outermost sample and two on
/// each side (one, where the strokes are short). Of a sine of n samples a cycle that is off by at
/// most (2π/n)⁶/200 of the amplitude.
double OvershootOfMotion(const ScaledRecord& record, std::size_t reversal);

/// A fit of records whose turning points were put in.
struct TurningPointFit {
  std::unique_ptr<ScaledRecords> records;
  Solution solution;
};

}  // namespace mindahl::identification
