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

/// Scatter of the residuals over the slope of the force by the displacement: white noise of the
/// displacement makes it large where branches are steep, and small on the plateau.
struct SlopeScatter {
  double deviation = 0.0;      // likeliest standard deviation of the displacement's noise [m]
  double p_value = 1.0;        // that noise of the force alone makes it
  double of_readings = 0.0;    // standard deviation of what is not smooth in the readings [m]
  double p_of_readings = 1.0;  // that noise of that size makes it
};

/// Compares second differences of the residuals within the strokes, d = (r₋₁ − 2r₀ + r₊₁)/√6, which
/// what is smooth along a branch does not reach, with the variance σ_F² + σ_δ²·⟨s²⟩, s = dT/dδ.
/// Both chances are of the likelihood ratio, over 1.94 since neighbouring differences share
/// samples, by χ² of one degree of freedom; of σ_δ = 0, a bound, by half of it.
///
/// Nothing for a displacement that an encoder read, that is held or smoothed, or that answers an
/// imposed force, and where what is not smooth in the readings would be too little to matter.
/// @param theta     of the solution
/// @param residual  weighted, of every sample of the problem
std::optional<SlopeScatter> FindSlopeScatter(const loop::PreparedRecords& prepared,
                                             const Problem& problem, std::span<const double> theta,
                                             std::span<const double> residual, Response& response);

/// Returns the noise of the displacement [m] with which a fit is tried again: what the residuals
/// show, and the readings do not deny; and where the model is doubted, what the readings show, and
/// the residuals do not deny. Their own differences bound the noise of the readings from above.
std::optional<double> NoiseToTry(const SlopeScatter& scatter, bool is_doubted,
                                 const Thresholds& thresholds);

}  // namespace mindahl::identification
