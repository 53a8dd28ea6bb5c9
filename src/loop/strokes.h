#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/extremes.h"
#include "loop/rules.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// The samples from one turning point to the next.
struct Stroke {
  std::span<const double> displacement;  // [m]
  std::span<const double> force;         // [N]

  [[nodiscard]] bool rises() const { return displacement.back() > displacement.front(); }
  [[nodiscard]] double range() const {
    const Extremes extremes = ExtremesOf(displacement);
    return extremes.greatest - extremes.least;
  }
  [[nodiscard]] double travel() const {
    return std::abs(displacement.back() - displacement.front());
  }
  [[nodiscard]] double lower_end_force() const { return rises() ? force.front() : force.back(); }
  [[nodiscard]] double upper_end_force() const { return rises() ? force.back() : force.front(); }
};

inline Stroke StrokeOf(const RecordView& record, std::size_t first, std::size_t last) {
  return {record.displacement.subspan(first, last - first + 1),
          record.force.subspan(first, last - first + 1)};
}

/// A pair of neighbouring extremes that is left when all smaller ones are taken out: under a gate
/// of its range or more it makes no reversal.
struct Excursion {
  double range = 0.0;     // [m]
  std::size_t first = 0;  // samples of its two extremes
  std::size_t last = 0;
  std::size_t reversals = 0;  // that vanish with it: 2, or 1 where an end of the record is in it

  [[nodiscard]] std::size_t duration() const { return last - first; }
};

/// True if one step between samples makes much of an excursion, which is then a jump.
inline bool IsOneStep(std::span<const double> displacement, const Excursion& excursion) {
  for (std::size_t i = excursion.first + 1; i <= excursion.last; ++i) {
    const double step = std::abs(displacement[i] - displacement[i - 1]);
    if (step >= ReversalRules::kJump * excursion.range) return true;
  }
  return false;
}

/// Returns the excursions of a displacement, by range. Closed inner loops by the four-point rule
/// (ASTM E1049 describes an equivalent one), the record's ends being extremes; what is left widens
/// up to the widest and then narrows, and goes one reversal at a time, from its ends. Cost: n, and
/// m log m for m extremes.
std::vector<Excursion> FindExcursions(std::span<const double> displacement);

/// Returns the number of reversals that FindReversals finds under the gate [m].
std::size_t CountReversals(std::span<const Excursion> excursions, double gate);

/// Returns the reversals, with the record's first and last sample where they lie at an extreme.
std::vector<std::size_t> TurningPoints(std::span<const double> displacement,
                                       std::span<const std::size_t> reversals);

/// Least and greatest mean over a twentieth of the stroke: what the force keeps to, not its noise.
std::pair<double, double> MovingMeanRange(std::span<const double> force);

/// Returns ∮ T dδ [J] from one turning point to the next but one, closed by a chord.
double CycleEnergy(const RecordView& record, std::size_t first, std::size_t last);

/// Returns the energy of each closed cycle [J] = ∮ T dδ by the trapezoidal rule, closed by a chord:
/// from every other reversal to the next but one. The record's ends count as reversals where they
/// lie within 2 % of the range of the extreme on their side. Positive when the contact dissipates
/// and the force is that of the contact, with the displacement's sign.
/// @throws InvalidArgument where an energy exceeds the largest double
/// Summed in long double: where it has 64 bits the error is below 1 ε of the result plus n·2⁻⁶² of
/// Σ|½(Tᵢ + Tᵢ₋₁)Δδᵢ|, forces counted from the first of the cycle's n samples.
std::vector<double> CycleEnergies(const RecordView& record, std::span<const std::size_t> reversals);

/// @param record     valid, not empty
/// @param reversals  as from FindReversals on the same record
LoopMeasures MeasureLoop(const RecordView& record, std::span<const std::size_t> reversals);

/// Returns +1 for a force with the displacement's sign, −1 for the opposite (load cell on the other
/// body): the sign of the mean energy of the closed cycles, which no offset changes; that of the
/// covariance of force and displacement without a closed cycle, or where the loop is under 1 % of
/// the rectangle round it or five standard deviations of what noise of both channels makes of its
/// energy, so that noise would decide. 0 when neither has a sign (constant force or displacement).
/// @param record  valid, not empty
int ForceSense(const RecordView& record, std::span<const std::size_t> reversals);

}  // namespace mindahl::loop
