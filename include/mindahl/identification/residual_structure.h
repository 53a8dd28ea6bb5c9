#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace mindahl::identification {

/// Mean residual over a part of the stroke.
struct StrokeBin {
  double position = 0.0;        ///< middle, as a share of the way from one reversal to the next
  double mean = 0.0;            ///< [N]
  double standard_error = 0.0;  ///< [N], from the scatter between strokes; 0 for a single one
};

/// The strokes of one direction.
struct StrokeResiduals {
  int direction = 1;        ///< +1 where the displacement grows
  std::size_t strokes = 0;  ///< that count, at least three quarters as long as the longest
  double mean = 0.0;        ///< [N]
  double rms = 0.0;         ///< [N]
  std::vector<StrokeBin> bins;
};

/// What a model misses, stroke for stroke.
struct ResidualStructure {
  std::array<StrokeResiduals, 2> directions;  ///< growing, then falling displacement
  /// Share of the residuals' variance that comes back at the same place of every stroke: 0 for
  /// noise, 1 for what the model cannot follow. 0 where an F test at 0.1 % finds nothing, or a
  /// direction has one stroke only.
  double repeatable_share = 0.0;
  std::size_t strokes = 0;  ///< of the direction that has more
};

/// One-way analysis of variance of residuals over 20 parts of each stroke.
/// @param displacement  [m]
/// @param reversals     as from FindReversals
/// @param residual      [N], same size as displacement; an exact 0 does not count
ResidualStructure DescribeStructure(std::span<const double> displacement,
                                    std::span<const std::size_t> reversals,
                                    std::span<const double> residual);

}  // namespace mindahl::identification
