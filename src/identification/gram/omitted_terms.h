#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/inference/departures.h"
#include "identification/inference/estimates.h"

namespace mindahl::identification {

/// Holds what a fit's model may lack, all terms of Departures() together: r = −Jδ − Cγ + ε with
/// γ_k ~ N(0, τ²/‖c_k‖²), τ by the marginal likelihood, and ε the noise process of what all columns
/// leave: what a model misses is smooth along the loop and would pass for autocorrelated noise.
struct AdequacyTest {
  Adequacy adequacy;  // without a verdict: the misfit is that of C·E(γ) beside J, or of one term
  double degrees_of_freedom = 1.0;  // of the noise
  Eigen::VectorXd step;             // E(δ), one a free parameter
  Eigen::VectorXd error;            // standard deviation of δ, γ integrated out
  std::vector<OmittedTerm> causes;  // CausesOf() the terms that the record can identify
};

/// Returns the terms that noise alone does not make, the best first, without those that another
/// beats clearly.
std::vector<OmittedTerm> CausesOf(std::vector<OmittedTerm> terms, const Thresholds& thresholds);

/// Tests a fit. Residuals that errors of the displacement make are noise, too.
AdequacyTest TestAdequacy(const Estimates& fitted);

}  // namespace mindahl::identification
