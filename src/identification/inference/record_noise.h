#pragma once

#include <span>

#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Bartlett's test that the residuals of all records have one variance: Σν_r·ln(s²/s_r²) against χ²
/// of one degree less than records, ν_r each record's effective samples less its parameters. A
/// record with few of them has no say.
/// @param residual  weighted, of every sample
/// @returns the chance that noise of one variance makes them so unlike; 1 of one record, and where
///   residuals are rounding errors
double ChanceOfOneNoise(const Problem& problem, std::span<const double> residual);

/// Parameters that a record takes up: its own, and its part of the contact's by its samples.
double ParametersOfRecord(const Problem& problem, std::size_t record);

}  // namespace mindahl::identification
