#pragma once

#include <optional>
#include <span>
#include <vector>

#include "identification/gram/omitted_terms.h"
#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/facts.h"

/// Judges whether a model describes a record, and compares the force that it misses with what was
/// measured without a model: never with a fitted slip force, which may be as wrong as the model.
namespace mindahl::identification {

/// True if Tc ran away from a loop that slides: it is more than a quarter off the half gap that was
/// measured, and no nearer to it than before.
/// @param without  Tc [N] of the smaller model
/// @param with     of the larger one
bool LeavesHalfGap(const loop::LoopFacts& facts, double without, double with);

/// Returns the options of a second fit, with a slip force no larger than the largest force, where
/// the loop slides over most of its stroke and a law that misses more than poor_misfit carries its
/// slip force nowhere: the loop has carried it. Nothing where that is not so, where the other law
/// is preferred, or the user limits Tc.
std::optional<FitOptions> WithinMeasuredForce(const FitResult& result, const FitOptions& options);

/// Returns the rms of what the model misses [N or m]. Of residuals that look like noise it is the
/// part that the causes explain or that comes back in every stroke; of others all of them but their
/// white noise.
double MissedForce(const FitResult& result);

/// Returns the variance [N² or m²] of the white part of the residuals that count: 2/3 of the mean
/// square of a residual's distance from the middle of its neighbours (Gasser, Sroka &
/// Jennen-Steinmetz 1986).
double WhiteVariance(const FitResult& result);

/// Returns the omitted terms that noise alone does not make, the best first, without those that
/// another beats clearly.
std::vector<OmittedTerm> CausesOf(const AdequacyTest& test, const Thresholds& thresholds);

/// Returns the misfit, its chance, its causes and the verdict: doubtful where noise hardly makes
/// what all omitted terms explain, the search ended at a limit of its own, the residuals are unlike
/// noise, or they exceed the noise that the record has without a model.
/// @param causes  result of CausesOf()
Adequacy JudgeAdequacy(const ScaledRecords& data, const AdequacyTest& test,
                       std::span<const OmittedTerm> causes, bool is_limited,
                       const FitResult& result, const Thresholds& thresholds);

/// True if intervals include what omitted terms would change: those of a model that is not
/// adequate, and where noise alone does not often make what the terms explain.
bool MayOmitTerms(const Adequacy& adequacy, const Thresholds& thresholds);

/// True if residuals are a poor misfit and change slowly: from one stroke to the next of a
/// direction they correlate by more than carried_over, or by ρ = 1 − DW/2 from one sample to the
/// next for −1/ln ρ samples, longer than noise_memory.
bool AreUnlikeNoise(const FitResult& result, const Thresholds& thresholds);

/// Sets `misfit`, `misfit_over_half_gap` and `use` of the adequacy. Without a half gap the use is
/// judged by T*.
void GradeUse(const Thresholds& thresholds, FitResult& result);

/// True unless the loop is so small against the rest of the force that its shape and height are
/// those of the rest.
bool IsLoopSeen(const FitResult& result, const Thresholds& thresholds);

/// Sets the verdict on each parameter, from estimates and findings alone: the worst of
///  - not identifiable without an interval, bounded below where the interval is open above;
///  - what each finding that names the parameter calls for (kFindings);
/// whatever the order of the findings (Identifiability is in the order of precedence). What the
/// user holds is identifiable. A finding that names no parameter changes none.
void Judge(std::span<ParameterEstimate> estimates, std::span<const Finding> findings);

/// Withdraws errors, limits, tests and findings on parameters where nothing of a model is to be
/// believed: where its misfit is no noise and as large as failing_misfit or, as kind "no_loop",
/// where no loop is seen in the force. Adds `model_inadequate`, which names the parameters. Before
/// Judge().
void WithdrawIfInadequate(const Thresholds& thresholds, FitResult& result);

}  // namespace mindahl::identification
