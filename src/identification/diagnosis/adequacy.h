#pragma once

#include <optional>
#include <span>
#include <vector>

#include "identification/gram/omitted_terms.h"
#include "identification/problem/problem.h"
#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// True if noise hardly makes what all omitted terms explain.
bool IsDoubtful(const AdequacyTest& test, const Thresholds& thresholds);

/// Returns the omitted terms that noise alone does not make, the best first, without those that
/// another beats clearly.
std::vector<DepartureFit> CausesOf(const AdequacyTest& test, const Thresholds& thresholds);

/// True if a column follows the force of the fitted model: its factor would take a part of Tc.
bool FollowsContact(std::span<const double> column, std::span<const double> fitted_force);

/// Returns the misfit, its chance and its causes.
/// @param causes  result of CausesOf()
Adequacy JudgeAdequacy(const ScaledRecords& data, const AdequacyTest& test,
                       std::span<const DepartureFit> causes);

/// True if the record hardly determines whether the contact was virgin or in a steady loop.
/// @param delta_aicc  of the two
bool PastIsUndecided(double delta_aicc, const Thresholds& thresholds);

/// True if residuals are a poor misfit and remember for longer than noise_memory: by their
/// autocorrelation at one sample, ρ = 1 − DW/2, for −1/ln ρ samples. Noise of that length would be
/// confounded with whatever changes slowly.
bool RemembersTooLong(const FitResult& result, const Thresholds& thresholds);

/// A misfit that is no noise and as large as failing_misfit, wherever it comes back; or a force in
/// which no loop is seen.
bool IsInadequate(const FitResult& result, const Thresholds& thresholds);

}  // namespace mindahl::identification
