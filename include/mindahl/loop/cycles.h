#pragma once

#include <cstddef>
#include <memory_resource>
#include <span>
#include <vector>

#include "mindahl/loop/record.h"

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

/// Returns the energy of each closed cycle [J] = ∮ T dδ by the trapezoidal rule, closed by a chord:
/// from every other reversal to the next but one. The record's ends count as reversals where they
/// lie within 2 % of the range of the extreme on their side. Positive when the contact dissipates
/// and the force is that of the contact, with the displacement's sign.
/// @throws InvalidArgument where an energy exceeds the largest double
/// Summed in long double: where it has 64 bits the error is below 1 ε of the result plus n·2⁻⁶² of
/// Σ|½(Tᵢ + Tᵢ₋₁)Δδᵢ|, forces counted from the first of the cycle's n samples.
std::vector<double> CycleEnergies(const RecordView& record, std::span<const std::size_t> reversals);

/// @param reversals  as from FindReversals on the same record
/// @throws InvalidArgument when the record is empty or inconsistent
LoopMeasures MeasureLoop(const RecordView& record, std::span<const std::size_t> reversals,
                         std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

/// Returns +1 for a force with the displacement's sign, −1 for the opposite (load cell on the other
/// body): the sign of the mean energy of the closed cycles, which no offset changes; that of the
/// covariance of force and displacement without a closed cycle, or where the loop is under 1 % of
/// the rectangle round it or five standard deviations of what noise of both channels makes of its
/// energy, so that noise would decide. 0 when neither has a sign (constant force or displacement).
/// @throws InvalidArgument when the record is inconsistent
int ForceSense(const RecordView& record, std::span<const std::size_t> reversals,
               std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace mindahl::loop
