#pragma once

#include <span>
#include <vector>

#include "identification/candidate.h"
#include "identification/noise_model.h"
#include "mindahl/identification/fit.h"

namespace mindahl::identification {

/// α of the virgin, the unloading and the reloading branches on their own, by one linear
/// least-squares step from the fit with a column for each in place of the one for α. Kinds of
/// branch with fewer than ten samples that count are left to the others.
/// @param variance  of a residual, in units of the data, inflated as standard errors are; it counts
///                  by the share that the step leaves of the squared residuals
/// @returns empty where α is held or at a bound, or only one kind of branch is there
std::vector<BranchShape> FitBranchShapes(const Candidate& candidate, const ScaledRecords& data,
                                         const NoiseModel& noise,
                                         std::span<const std::size_t> record_rows, double variance);

}  // namespace mindahl::identification
