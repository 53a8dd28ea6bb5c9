#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// Holds the facts of one closed cycle, from a turning point to the next but one. X and T* are half
/// ranges, so that no offset matters; a fact that the cycle does not show is empty.
struct CycleFacts {
  std::size_t start = 0;   ///< sample of its first turning point
  double amplitude = 0.0;  ///< X [m]: a quarter of the travel of its two strokes
  /// T* [N]: half the range of the force, over moving means of 1/20 of a stroke (against noise) and
  /// the values at the turning points.
  double peak_force = 0.0;
  double energy = 0.0;        ///< W [J] = ∮ T dδ, closed by a chord
  double energy_ratio = 0.0;  ///< W/(4XT*) [-]: 1 of a rectangle, 0 of a line
  bool steady = false;        ///< true if it counts and is within 5 % of the widest that do
  /// [N]: half the force between the strokes, in the middle third of the stroke: the median of the
  /// means over five parts of it. Of a loop that slips it is the slip force.
  std::optional<double> half_gap;
  std::optional<double> centre_force;  ///< [N]: midway between the strokes, in the same place
  /// [m]: half the displacement between the strokes where the force is within T*/10 of
  /// `centre_force`: how far the contact slides, X less what the stick takes.
  std::optional<double> sliding_amplitude;
};

/// Holds what a record shows without any model. Means are those of the widest steady cycles, whose
/// amplitude is at least 0.95 of the widest cycle's.
struct LoopFacts {
  /// Complete cycles: half the swings between reversals, rounded down; the ways from the record's
  /// start and to its end count by their length, 0.02 cycles short of one is one.
  std::size_t complete_cycles = 0;
  /// X [m]: the mean of steady cycles'; where none closes half the mean range of the strokes that
  /// are at least 0.95 times as wide as the widest, else half the record's
  double amplitude = 0.0;
  double peak_force = 0.0;  ///< T* [N]: the median of steady cycles', else half the force's range
  bool closed = false;      ///< false: the record closes no cycle, and there are no facts but these
  std::vector<CycleFacts> cycles;
  std::size_t steady_cycles = 0;                      ///< number of cycles of the widest amplitude
  double energy_per_cycle = 0.0;                      ///< W [J]
  double energy_ratio = 0.0;                          ///< W/(4XT*) [-]
  std::optional<double> sliding_amplitude;            ///< [m]
  std::optional<double> half_gap;                     ///< [N]
  std::optional<double> half_gap_standard_deviation;  ///< [N] between cycles; of two or more
  /// [-]: how far the falling stroke is from the rising one turned about the loop's centre, over
  /// T*: of the forces U_j and D_j in ten parts of the strokes the standard deviation of (U_j +
  /// D_{11−j})/2. Zero of a loop that has the symmetry of a contact; a slope of both strokes and
  /// offsets do not enter.
  std::optional<double> asymmetry;
};

/// True if the gap between the strokes is the same over the stroke, to a tenth of its energy: of a
/// contact that slides, whatever force of the position lies beside it.
bool HasEvenGap(const LoopFacts& facts);

/// True if a measured loop slides over most of its stroke, so that its half gap is the slip
/// force's, whatever the law: the gap is more than half of T*, and the energy ratio at least 0.6
/// or, as beside a spring parallel to the contact, the gap the same over the stroke to a tenth.
bool Slides(const LoopFacts& facts);

/// True if a measured loop slides over most of its stroke, or reaches its slip force at the ends,
/// however much of it a rig takes up: its energy is 0.85 of 4·T*·sliding amplitude or more.
/// Mindlin's contact has it from 1.2 times its gross-slip displacement on, one with α = 1 at T* =
/// 0.993 Tc; an ellipse has π/4. A spring parallel to the contact hides it.
bool HasSlipped(const LoopFacts& facts);

/// Returns ∮ T dδ [J] from one sample to a later one, trapezoidal, closed by a chord.
/// @throws InvalidArgument when it overflows
/// The sum has an error below 1 ε of the result plus n·2⁻⁶²·Σ|½(Tᵢ + Tᵢ₋₁)Δδᵢ| on platforms whose
/// long double has a mantissa of 64 bits; n is the number of samples, and Tᵢ is measured from the
/// force at the first of them.
double CycleEnergy(const RecordView& record, std::size_t first, std::size_t last);

/// @param record       with the force of either sign
/// @param reversals    as from FindReversals on the same record; its first and last sample may be
///                     among them, where it is known to begin or end at one
/// @param force_sense  ±1, see ForceSense; forces are given the displacement's sign
/// @param counts       one per sample: 1 where it counts; empty: all do. A cycle most of which does
///                     not is not steady, unless there is no other
/// @throws InvalidArgument when the record is empty or inconsistent, or an energy overflows
/// Cost: linear in the samples.
LoopFacts MeasureFacts(const RecordView& record, std::span<const std::size_t> reversals,
                       int force_sense, std::span<const unsigned char> counts = {});

/// Gives the force the opposite sign in facts that were measured.
void TurnForce(LoopFacts& facts);

/// Returns +1 for a force with the displacement's sign, −1 for the opposite (load cell on the other
/// body): the sign of the mean energy of the closed cycles, which no offset changes; that of the
/// covariance of force and displacement without a closed cycle, or where the loop is under 1 % of
/// the rectangle round it or five standard deviations of what noise of both channels makes of its
/// energy, so that noise would decide. 0 when neither has a sign (constant force or displacement).
/// @param record  valid, not empty
/// @param facts   its own, measured with the force as it is
int ForceSense(const RecordView& record, const LoopFacts& facts);

}  // namespace mindahl::loop
