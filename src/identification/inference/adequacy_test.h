#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "identification/inference/departures.h"
#include "identification/inference/estimates.h"

namespace mindahl::identification {

/// Predicts the fit with one omitted term added, by one linear step; only the p-value of a term
/// that noise may well have made.
struct DepartureFit {
  std::size_t departure = 0;                  // its place in Departures()
  std::optional<std::size_t> covariate = {};  // which, among those of ScaledRecords
  double p_value = 1.0;                       // that noise alone makes it
  double delta_aicc = 0.0;                    // against the fit without
  double explains = 0.0;                      // fraction of the sum of squares
  double size = 0.0;                          // of its first column, in its unit
  double size_p_value = 1.0;                  // that noise alone makes that
  std::string_view unit = {};
  bool is_measured = false;        // without the model, and fitted as it was
  std::vector<double> step = {};   // of θ, one a free parameter
  std::vector<double> error = {};  // standard error of θ with it, likewise
};

/// Tests residuals against noise: what no omitted term explains counts as noise, with the
/// autocorrelation that it has. What the model misses is smooth along the loop and would pass for
/// autocorrelated noise otherwise.
struct AdequacyTest {
  double misfit_over_noise = 0.0;
  double p_value = 1.0;
  double noise = 0.0;               // standard deviation of a weighted residual
  double degrees_of_freedom = 1.0;  // of the noise
  double effective_samples = 1.0;   // of it
  std::vector<DepartureFit> fits;   // of the terms that the record can identify
};

/// @param displacement  what drawn errors of the displacement do to the residuals: that is noise
/// too
AdequacyTest TestAdequacy(const FittedProblem& fitted, const DisplacementEffect& displacement,
                          const Thresholds& thresholds, Response& response);

/// Returns the shift of a parameter by a term, in halves of its 95 % interval; 0 where it is open.
double MoveOf(const Problem& problem, const Solution& solution, const DepartureFit& fit,
              std::size_t parameter, const ParameterEstimate& estimate);

/// Inflates intervals to cover the parameters with each of the omitted terms.
void WidenByDepartures(const Problem& problem, const Solution& solution,
                       std::span<const DepartureFit> fits, double quantile,
                       std::span<ParameterEstimate> estimates);

}  // namespace mindahl::identification
