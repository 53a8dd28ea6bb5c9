#pragma once

#include <span>
#include <string>
#include <vector>

#include "identification/inference/noise.h"
#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

/// Intervals that cover what another reading of the record would have for the parameters.
namespace mindahl::identification {

/// Holds a competing solution for a record, and the reason why intervals extend to it.
struct Rival {
  const Problem& problem;
  const Solution& solution;
  IntervalSource source;
};

/// Extends intervals to σ, α and Tc of a competing solution, as of the other initial state; an end
/// that is open there is open then. Leaves the response bound to `problem`.
/// @param peak_force  largest |force| of the record [N]: no slip force lies below it
/// @returns the names of those that the competing solution has outside this one's interval
std::vector<std::string> CoverRival(const Problem& problem, const Rival& rival, const Noise& noise,
                                    const Thresholds& thresholds, double peak_force,
                                    Response& response, std::span<ParameterEstimate> estimates);

/// True if a solution of the same problem lies outside an interval that is closed, of σ, α or Tc,
/// and the noise does not exclude it: 2 ln Λ is below the quantile of χ² of the confidence.
bool IsAnotherMinimum(const Problem& problem, const Solution& best, const Solution& other,
                      const Noise& noise, std::span<const ParameterEstimate> estimates);

/// Returns Tc with its interval extended to half of the measured gap between the branches, where
/// the shape of the loop is doubtful and the record slips.
ParameterEstimate CoverPlateau(const FitResult& result, const Thresholds& thresholds);

/// Returns Tc with the lower end of its interval raised to the half gap that was measured between
/// the strokes, less two of its standard deviations between cycles and one of the noise: the
/// contact carried that force in either direction, so that it slips at no less. Where the model has
/// no other force that turns with the motion (a viscous one, a covariate, a lag), and no cause is
/// one.
ParameterEstimate KeepAboveCarriedForce(const FitResult& result);

}  // namespace mindahl::identification
