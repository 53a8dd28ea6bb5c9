#pragma once

#include <optional>

#include "mindahl/identification/fit.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::report {

enum class SlipRegime { kPartial, kGross };

/// Holds the measured amplitude, force and energy of a record's loop.
struct MeasuredLoop {
  double amplitude = 0.0;        ///< X [m]
  double peak_force = 0.0;       ///< T* [N]
  std::optional<double> energy;  ///< W [J] per cycle; empty where the record closes none
};

/// The steady loop of the fitted law at the amplitude of the widest record.
struct LoopDescription {
  MeasuredLoop measured;
  double contact_amplitude = 0.0;  ///< X [m] of the contact alone, the rig's travel taken off
  double model_energy = 0.0;       ///< W [J] per cycle
  /// A = W/(4XT*) [-] with the measured X and T* and the measured W, or the model's where the
  /// record closes no cycle; empty where X or T* is 0.
  std::optional<double> energy_ratio;
  /// Amplitude [m] of the contact from which the fitted law's steady loop slips grossly: δc,
  /// 2^−α·δc of Dahl's own law; empty for α >= 1, which only approaches the slip force, and where
  /// the record leaves σ, α or Tc open.
  std::optional<double> gross_slip_displacement;
  /// Energy ratio [-] at that amplitude, the rig's travel in X; likewise.
  std::optional<double> gross_slip_energy_ratio;
  /// Whether the record says when the contact slips: σ, α and Tc are identifiable or held.
  bool knows_slip = true;
  double slip_force_share = 0.0;  ///< T*/Tc [-] of the law
  /// c/a [-] of a Mindlin contact under T*, 0 in gross slip; empty where the regime is.
  std::optional<double> stick_radius_ratio;
  /// Fraction of the measured strokes' travel, given where the loop slides (loop::Slides); the
  /// regime is then gross, whatever the fitted law says.
  std::optional<double> sliding_fraction;
  /// Empty where Tc has no value, nor a lower limit of which the fitted law stays short.
  std::optional<SlipRegime> regime;
};

/// Fraction of Tc from which a law with α >= 1 is said to slip as a whole, which it never quite
/// does: no record determines 1 % of the force.
inline constexpr double kAsGoodAsSlip = 0.99;

/// True if a law's steady loop of amplitude X [m] of the contact reaches gross slip.
bool SlipsGrossly(const models::FrictionModel& model, const models::BranchLaw& law,
                  double contact_amplitude);

/// Measures the widest steady cycles; where none is closed, the main swings.
MeasuredLoop MeasuredLoopOf(const identification::RecordFit& record);

/// @param fit  one that did not fail
LoopDescription DescribeLoop(const identification::FitResult& fit);

}  // namespace mindahl::report
