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

/// Covers σ, α and Tc of a fit from the other past of the contact; an end that is open there is
/// open then. Leaves the response bound to `problem`.
/// @param peak_force  largest |force| of the record [N]: no slip force lies below it
/// @returns the names of those that the other past has outside the interval of this one
std::vector<std::string> CoverRivalPast(const Problem& problem, const Problem& rival,
                                        const Solution& rival_solution, const Noise& noise,
                                        const Thresholds& thresholds, double peak_force,
                                        Response& response, std::span<ParameterEstimate> estimates);

/// Where the shape of a loop is doubtful, the plateau that anyone reads off it is as good a slip
/// force as the law's: Tc covers half of the gap between the branches, where the record slips.
void CoverPlateau(FitResult& result, const Thresholds& thresholds);

/// Raises the lower end of Tc to the half gap that was measured between the strokes, less two of
/// its standard deviations between cycles and one of the noise: the contact carried that force in
/// either direction, so that it slips at no less. Where the model has no other force that turns
/// with the motion (a viscous one, a covariate, a lag), and no cause is one.
void KeepAboveCarriedForce(FitResult& result);

}  // namespace mindahl::identification
