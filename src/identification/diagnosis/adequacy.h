#pragma once

#include <span>

#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/facts.h"

/// Judges whether a model describes a record, and compares the force that it misses with what was
/// measured without a model: never with a fitted slip force, which may be as wrong as the model.
namespace mindahl::identification {

/// True if Tc [N] of a larger model ran away from a loop that slides: it is more than a quarter off
/// the half gap that was measured, and no nearer to it than that of the model without the terms.
bool LeavesHalfGap(const loop::LoopFacts& facts, double without, double with);

/// Returns the rms of what the model misses [N or m]: of residuals that look like noise the part
/// that the causes explain or that repeats in every stroke, of others all but their white noise.
double MissedForce(const FitResult& result);

/// Judges a fit, of which omitted terms were tested, doubtful where noise hardly makes what they
/// explain, the search ended at a limit of its own, the residuals are unlike noise, or exceed that
/// of the record itself.
void JudgeAdequacy(bool is_limited, const Thresholds& thresholds, FitResult& result);

/// True if intervals include what omitted terms would change: those of a model that is not
/// adequate, and where noise alone does not often make what the terms explain.
bool MayOmitTerms(const Adequacy& adequacy, const Thresholds& thresholds);

/// True if residuals are a poor misfit and change slowly: from one stroke to the next of a
/// direction they correlate by more than carried_over, or by ρ = 1 − DW/2 from one sample to the
/// next for −1/ln ρ samples, longer than noise_memory.
bool AreUnlikeNoise(const FitResult& result, const Thresholds& thresholds);

/// Sets `misfit`, `misfit_over_half_gap` and `use`, which T* decides without a half gap.
void GradeUse(const Thresholds& thresholds, FitResult& result);

/// True unless the loop is so small that its shape and height are those of the rest of the force.
bool IsLoopSeen(const FitResult& result, const Thresholds& thresholds);

/// Sets the verdict on each parameter: the last in the order of Identifiability of what its
/// interval says (not identifiable without one, bounded below where it is open above) and what each
/// finding that names it calls for (kFindings). What the user holds is identifiable.
void Judge(std::span<ParameterEstimate> estimates, std::span<const Finding> findings);

/// Withdraws intervals and findings on parameters where the misfit is no noise and as large as
/// failing_misfit or, as kind "no_loop", no loop is seen in the force. Adds `model_inadequate`,
/// which names the parameters. Before Judge().
void WithdrawIfInadequate(const Thresholds& thresholds, FitResult& result);

}  // namespace mindahl::identification
