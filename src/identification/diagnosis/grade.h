#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/facts.h"

/// How large the force is that a model misses, against what was measured without a model: never
/// against a fitted slip force, which may be as wrong as the model.
namespace mindahl::identification {

/// True if a slip force [N] ran away: it is more than a quarter off the measured half gap [N].
bool RanAway(double slip_force, double half_gap);

/// True if, of a loop that slides, Tc ran away from the half gap that was measured, no nearer than
/// before.
/// @param without  Tc [N] of the smaller model
/// @param with     of the larger one
bool LeavesHalfGap(const loop::LoopFacts& facts, double without, double with);

/// Returns the options with a slip force no larger than the largest force of a loop that slides
/// over most of its stroke, where a law carries its slip force nowhere: the loop has carried it.
/// Nothing where that is not so or the user limits Tc.
/// @param load_ratio  of the loop's record
/// @param slip_force  [N] of the law
std::optional<FitOptions> WithinMeasuredForce(const loop::LoopFacts& facts, double load_ratio,
                                              double slip_force, const FitOptions& options);

/// Returns half the gap between the strokes of the widest record [N], as it would be at the mean
/// load of all; empty in a fit of the displacement, and where none was measured or it is not > 0.
std::optional<double> MeasuredHalfGap(const FitResult& result);

/// Returns what a misfit is held against [N or m]: the half gap of a loop that slides or reaches
/// slip, else T*; of a displacement its amplitude.
double ScaleOfMisfit(const FitResult& result);

/// Returns the rms of what the model misses [N or m]. Of residuals that look like noise it is the
/// part that the causes explain or that comes back in every stroke; of others all of them but their
/// white noise, whose variance is 2/3 of the mean square of a residual's distance from the middle
/// of its neighbours (Gasser, Sroka & Jennen-Steinmetz 1986).
double MissedForce(const FitResult& result);

/// Returns the variance [N² or m²] of the white part of the residuals that count.
double WhiteVariance(const FitResult& result);

/// Returns the adequacy, doubtful where the residuals exceed 1.5 times the noise that the
/// record has without a model: what does not repeat from stroke to stroke (pure error), or of a
/// single cycle what differs between neighbouring samples. Tests of columns take a misfit that no
/// column explains for autocorrelated noise.
Adequacy DoubtedByNoise(const Thresholds& thresholds, const FitResult& result);

/// Returns the adequacy with `misfit`, `misfit_over_half_gap` and `use`. Without a half gap the use
/// is judged by T*.
Adequacy GradeUse(const Thresholds& thresholds, const FitResult& result);

}  // namespace mindahl::identification
