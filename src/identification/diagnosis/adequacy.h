#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "identification/gram/omitted_terms.h"
#include "identification/problem/problem.h"
#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// Returns the group of terms, or nothing where the fit has it or its requirements refuse it.
/// @param group  as a cause names it; may be empty
std::string_view AcceptedGroup(const Problem& problem, const FitOptions& options,
                               std::string_view group);

/// True if noise hardly makes what all omitted terms explain.
bool IsDoubtful(const AdequacyTest& test, const Thresholds& thresholds);

/// Returns the omitted terms that noise alone does not make, the best first, without those that
/// another beats clearly.
std::vector<DepartureFit> CausesOf(const AdequacyTest& test, const Thresholds& thresholds);

/// True if the size of a cause, that of its first column, differs from zero beyond noise. Where its
/// other columns make the cause, the size is zero within the noise.
bool SaysItsSize(const DepartureFit& cause, const Thresholds& thresholds);

/// Holds what a fit's adequacy is judged by.
struct AdequacyEvidence {
  const AdequacyTest& test;
  std::span<const DepartureFit> causes;  ///< result of CausesOf()
};

/// True if a column follows the force of the fitted model: its factor would take a part of Tc.
bool FollowsContact(std::span<const double> column, std::span<const double> fitted_force);

/// Returns the misfit, its chance and its causes: those that noise alone does not
/// make, the best first, without those that another beats clearly; of causes that explain nearly as
/// much as the best those that were measured, or can be tried, come first.
/// @param estimates  of the reported parameters, with the intervals that the model itself gives
Adequacy JudgeAdequacy(const Problem& problem, const Solution& solution,
                       const AdequacyEvidence& evidence, const FitOptions& options,
                       std::span<const ParameterEstimate> estimates);

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
