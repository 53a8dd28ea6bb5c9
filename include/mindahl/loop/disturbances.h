#pragma once

#include <cstddef>
#include <set>
#include <span>
#include <vector>

#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// Returns the standard deviation [m] of white noise on a smooth displacement, from the median of
/// its absolute third differences, which a smooth drive hardly enters; of an encoder that counts in
/// steps q, at least q/√12. Samples that repeat the one before say nothing new and are passed over.
///   σ_δ = 1.4826·median|x_i − 3x_{i−1} + 3x_{i−2} − x_{i−3}|/√20
/// 0 for fewer than four different samples. Efficiency about 0.4: 2 % at 5000 samples.
double EstimateDisplacementNoise(std::span<const double> displacement);

/// Returns the step [m] of the encoder that a displacement was read from: neighbours differ by
/// whole steps or not at all. 0 where it was not.
/// @param rests_at_turns  rests at turning points also count: those of a force, which rests where
///                        the contact slips, not those of a drive, which may dwell there
double EncoderStep(std::span<const double> readings, bool rests_at_turns = false);

/// Returns how far the windows reach, h samples to either side of each sample, over which a
/// displacement is smoothed where the motion is smooth.
/// Each sample becomes the value there of the parabola in the sample number through the 2h + 1
/// samples about it (Savitzky & Golay 1964), h as large as the motion allows: of growing windows
/// the intervals x̂ ± 2.5 s of the estimates must have a point in common (Goldenshluger &
/// Nemirovski 1997), and half of the widest that do is taken: the parabola's error falls with h⁴,
/// to a sixteenth, and the noise grows by √2 only. A corner narrows the windows that it lies in.
/// The ends of a record stay nearly as they are.
/// @param displacement  [m], finite
/// @param noise         standard deviation [m], >= 0; at 0 nothing is smoothed
/// @throws InvalidArgument when the noise is negative or not finite
std::vector<std::size_t> SmoothingReaches(std::span<const double> displacement, double noise);

/// Returns a displacement smoothed over such windows, in which it is linear.
/// @throws InvalidArgument for another number of samples
/// Cost: at most 128 additions a sample.
std::vector<double> Smoothed(std::span<const double> displacement,
                             std::span<const std::size_t> reaches);

/// Returns the reversals of a smoothed displacement: the outermost sample of each swing that noise
/// has made part of two strokes. Between them no sample lies beyond either.
/// @param smoothed   [m]
/// @param reversals  those of the displacement as it was read
std::vector<std::size_t> MoveReversals(std::span<const double> smoothed,
                                       std::span<const std::size_t> reversals);

/// A record without its glitches: lines over the samples that are left out. All empty where there
/// is no glitch; a channel is also empty where there is none in it.
struct Interpolated {
  std::set<std::size_t> glitches;    ///< samples
  std::vector<double> displacement;  ///< [m]
  std::vector<double> force;         ///< [N]
};

/// Finds the samples that no contact and no drive has made.
/// - A spike of 1 to 3 samples leaves its neighbours and comes back: it lies beyond both by more
///   than three times the steps about it (the third largest of 24) and of the record (of ten steps
///   nine are smaller). One of the force has up to 20 samples while the displacement goes on in one
///   direction. So corners, turning points of few samples a cycle, and square pulses that come
///   again are none.
/// - A dropout reads exactly 0 and 0, inside the record and outside its neighbours' range by more
///   than two such steps of the record in either channel; where one does, all inside that read so.
/// Glitches that make up more than a quarter of a channel are none. In the first and last two
/// samples no spike is found.
/// @param record  valid
/// Cost: linear in the samples.
Interpolated FindAndInterpolate(const RecordView& record);

}  // namespace mindahl::loop
