#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace mindahl::loop {

/// Samples at which the direction of displacement reverses.
///
/// A reversal is registered at an extremum once the displacement has retreated from it by more than
/// `gate`; smaller excursions are noise and make no reversal. With gate = 0 every change of
/// direction counts. Repeated displacements are no reversal; of a dwell, the first sample is the
/// extremum. Depends on the displacement alone, so it is done once a record whatever is fitted to
/// it.
///
/// @param displacement  [m], finite, in order of time
/// @param gate          [m], finite, >= 0
/// @returns indices into `displacement`, ascending; maxima and minima alternate
/// @throws InvalidArgument when the gate is negative or not finite
/// Cost: one pass.
std::vector<std::size_t> FindReversals(std::span<const double> displacement, double gate);

/// Gate [m] that separates reversals of the drive from reversals made by measurement noise.
///
/// The closed inner loops of the record (four-point rainflow count) are sorted by range. Noise
/// makes many small ones that last a few samples, or stay within the range of the noise or two
/// steps of the encoder; the drive makes large ones, and nothing lies between. The gate is set in
/// that gap: above the largest noise-like range, at most twice it. Where there is no gap - a clean
/// record, a white sequence, all but 1 % of random walks - it is 0. The noise is the median
/// absolute third difference, which a smooth drive hardly enters.
///
/// @param displacement  [m], finite
/// @returns [m], 0 when no inner loop looks like noise
double EstimateReversalGate(std::span<const double> displacement);

}  // namespace mindahl::loop
