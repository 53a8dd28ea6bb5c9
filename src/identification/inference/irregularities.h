#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "identification/inference/noise.h"
#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Something in a record that comes and goes, so that no column of forces is in proportion to it:
/// the residuals have a statistic of their own for it.
struct Irregularity {
  std::string_view code;
  std::string_view meaning;  // of the size
  std::string_view unit;
  std::string_view option;  // of the command line; empty where there is none
};

/// Holds the fit of one of them to the residuals.
struct IrregularityFit {
  std::size_t irregularity = 0;  // its place in Irregularities()
  double p_value = 1.0;          // that noise alone makes it
  double delta_aicc = 0.0;       // against the fit without
  double explains = 0.0;         // fraction of the sum of squares
  double size = 0.0;             // in its unit, forces in units of the data
};

std::span<const Irregularity> Irregularities();

/// Samples of a fit one by one, those that were measured, record after record.
struct FittedSample {
  std::size_t record = 0;
  double displacement = 0.0;
  double response = 0.0;  // of the contact over the slip force
  double residual = 0.0;  // weighted, model − measured
  bool counts = false;
  bool turns = false;  // the motion turns there
};

/// Finds those that the residuals show, if identifiable. Cost: n log n, negligible against a fit.
/// @param residual  weighted, of all samples
/// @param robust    large residuals count less already, and are not looked for
/// @param doubtful  then a ripple is looked for, and else only where the force drops: it costs more
///   than the rest
std::vector<IrregularityFit> FindIrregularities(const Problem& problem,
                                                std::span<const double> theta,
                                                std::span<const double> residual,
                                                const Noise& noise, bool robust, bool doubtful,
                                                Response& response);

/// Readings that are far off both their neighbours, more of them than noise of one width makes.
///   uᵢ = rᵢ − (rᵢ₋₁ + rᵢ₊₁)/2
/// is free of whatever is smooth along the loop. A reading is off where |uᵢ| is beyond six
/// deviations of the samples on which the force is as steep, by their median, and its neighbours'
/// are of the other sign: a corner of the residuals, or a step, is none.
/// @returns with the fraction of such readings as its size; empty where there is none
std::optional<IrregularityFit> FindHeavyTails(std::span<const FittedSample> samples,
                                              const Evidence& evidence);

/// Drops of the force, against the motion, that recur while the contact slides: a sawtooth. Of the
/// steps between samples on the plateau those beyond five deviations are counted; noise, whatever
/// its tails, makes as many rises as drops. Teeth of fewer than four samples pass for noise.
/// @returns with the median drop as its size [units of the data]; empty where there is none
std::optional<IrregularityFit> FindStickSlip(std::span<const FittedSample> samples);

/// Looks for a periodic force where the contact slides, as a drive screw or a gear makes: of the
/// periods between four readings and a third of the plateau the one whose cosine and sine, one
/// pair for each direction, explain most of the residuals' deviation from a line over each stroke.
/// It is a ripple where a pair for each stroke explains hardly more (stick-slip has another phase
/// in each), and none of another period three times as much; it is fitted with its first three
/// harmonics.
/// @returns with the period as its size [units of the data]; empty where there is none
std::optional<IrregularityFit> FindRipple(std::span<const FittedSample> samples);

}  // namespace mindahl::identification
