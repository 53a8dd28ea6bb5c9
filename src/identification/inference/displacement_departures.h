#pragma once

#include <cstddef>
#include <span>

#include "identification/inference/departures.h"
#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Omitted terms of a displacement that responds to an imposed force, to first order: the same
/// codes, where they have a meaning, as displacements in proportion to one to three columns.
/// @param most  columns that are wanted; fewer where the next term's do not fit
DepartureColumns ColumnsOfDisplacementDepartures(const Problem& problem,
                                                 std::span<const double> theta, Response& response,
                                                 std::size_t most);

}  // namespace mindahl::identification
