#pragma once

#include <optional>
#include <span>
#include <vector>

#include "identification/inference/adequacy_test.h"
#include "identification/inference/irregularities.h"
#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// True if noise hardly makes what all omitted terms, or the best of them, explain.
bool IsDoubtful(const AdequacyTest& test, const Thresholds& thresholds);

/// Returns the omitted terms that noise alone does not make, the best first, without those that
/// another beats clearly.
std::vector<DepartureFit> CausesOf(const AdequacyTest& test, const Thresholds& thresholds);

/// True if the size of a cause, that of its first column, differs from zero beyond noise. Where its
/// other columns make the cause, the size is zero within the noise.
bool SaysItsSize(const DepartureFit& cause, const Thresholds& thresholds);

/// @param estimates  of the reported parameters, with the intervals that the model itself gives
Adequacy JudgeAdequacy(const Problem& problem, const Solution& solution, const AdequacyTest& test,
                       std::span<const DepartureFit> causes, const FitOptions& options,
                       std::span<const ParameterEstimate> estimates);

/// Adds the disturbances that noise alone does not make to the causes, the best first, without
/// those that another beats clearly, and doubts the record where one is there. Of causes that
/// explain nearly as much as the best those that were measured, or can be tried, come first.
void AddIrregularities(const Problem& problem, std::span<const IrregularityFit> found,
                       const FitOptions& options, Adequacy& adequacy);

/// True if the record hardly determines whether the contact was virgin or in a steady loop.
/// @param delta_aicc  of the two
bool PastIsUndecided(double delta_aicc, const Thresholds& thresholds);

/// Residuals that are a poor misfit and remember for longer than noise_memory: by their
/// autocorrelation at one sample, ρ = 1 − DW/2, for −1/ln ρ samples. Noise of that length would be
/// confounded with whatever changes slowly.
std::optional<Finding> FindSlowResiduals(const FitResult& result, const Thresholds& thresholds);

/// A misfit that is no noise and as large as failing_misfit, wherever it comes back; or a force in
/// which no loop is seen.
bool IsInadequate(const FitResult& result, const Thresholds& thresholds);

}  // namespace mindahl::identification
