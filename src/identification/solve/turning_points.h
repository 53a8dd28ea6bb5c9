#pragma once

#include <memory>
#include <memory_resource>
#include <span>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/solver.h"

namespace mindahl::identification {

/// Records whose turning points lie beyond their outermost samples, by an overshoot each.
///
/// A record that is sampled coarsely misses the extremes of its motion; the branches that follow
/// then start in the wrong place, and no other parameter can correct that without a bias.
struct TurnedRecords {
  ScaledRecords data;  // with the turning points inserted next to the outermost samples
  std::pmr::vector<std::pmr::vector<std::size_t>> reversals;  // of `data`, which refers to them
};

/// @param overshoot  >= 0, one a reversal of all records
std::unique_ptr<TurnedRecords> PutInTurningPoints(const ScaledRecords& data,
                                                  std::span<const double> overshoot);

/// Returns how far the motion turns beyond a reversal's sample, by the samples about it alone: >=
/// 0, at most the longer of the adjacent steps. It turns where the lines through the two samples
/// before and the two after meet if its velocity changes there and hardly next to it, as that of a
/// triangle does; else at the extremum of the polynomial through the outermost sample and two on
/// each side (one, where the strokes are short). Of a sine of n samples a cycle that is off by at
/// most (2π/n)⁶/200 of the amplitude.
double OvershootOfMotion(const ScaledRecord& record, std::size_t reversal);

/// A fit of turned records.
struct TurningPointFit {
  std::unique_ptr<TurnedRecords> records;
  Solution solution;
};

}  // namespace mindahl::identification
