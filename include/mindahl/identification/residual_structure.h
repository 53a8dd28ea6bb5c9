#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace mindahl::identification {

/// Mean residual over a part of the stroke.
struct StrokeBin {
  double position = 0.0;        ///< middle, as a fraction of the stroke's travel
  double mean = 0.0;            ///< [N]
  double standard_error = 0.0;  ///< [N], from the scatter between strokes; 0 for a single one
};

/// The strokes of one direction.
struct StrokeResiduals {
  int direction = 1;        ///< +1 where the displacement grows
  std::size_t strokes = 0;  ///< number that count and are long enough
  double mean = 0.0;        ///< [N]
  double rms = 0.0;         ///< [N]
  std::vector<StrokeBin> bins;
};

/// Holds the mean residual by place in the stroke, in either direction.
struct ResidualStructure {
  std::array<StrokeResiduals, 2> directions;  ///< growing, then falling displacement
  /// Fraction of the residuals' variance that repeats at the same place of every stroke: 0 for
  /// noise, 1 for what the model cannot follow. 0 where an F test finds nothing, or a
  /// direction has one stroke only.
  double repeatable_share = 0.0;
  std::size_t strokes = 0;  ///< number in the direction that has more

  /// Returns the factor by which the variance of estimates exceeds that from noise: a residual that
  /// repeats in every stroke is not averaged away by more of them.
  [[nodiscard]] double Widening() const {
    return strokes > 1 ? 1 + repeatable_share * static_cast<double>(strokes - 1) : 1.0;
  }
};

struct ResidualStructureOptions {
  double main_stroke = 0.75;    ///< fraction of the longest; shorter strokes are left out
  double repeat_chance = 1e-3;  ///< at which white noise passes for repeatable
};

/// Makes a one-way analysis of variance of residuals over 20 parts of each stroke.
/// @param displacement  [m]
/// @param reversals     as from FindReversals
/// @param residual      [N], same size as displacement
/// @param counts        of each sample, 0 where it does not count; the same size
ResidualStructure DescribeStructure(std::span<const double> displacement,
                                    std::span<const std::size_t> reversals,
                                    std::span<const double> residual,
                                    std::span<const unsigned char> counts,
                                    const ResidualStructureOptions& options = {});

}  // namespace mindahl::identification
