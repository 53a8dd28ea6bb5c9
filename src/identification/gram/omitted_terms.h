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
  double misfit_over_noise = 0.0;   // rms of C·E(γ) beside J, or of one term, over the noise
  double p_value = 1.0;             // that noise alone looks so
  double noise = 0.0;               // standard deviation of a weighted residual
  double degrees_of_freedom = 1.0;  // of the noise
  Eigen::VectorXd step;             // E(δ), one a free parameter
  Eigen::VectorXd error;            // standard deviation of δ, γ integrated out
  std::vector<OmittedTerm> fits;    // of each term that the record can identify
};

/// Tests a fit. Residuals that errors of the displacement make are noise, too.
AdequacyTest TestAdequacy(const Estimates& fitted);

}  // namespace mindahl::identification
