#pragma once

#include <span>
#include <string>

#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/pooled_value.h"
#include "mindahl/identification/fit_options.h"

// One shape exponent for all cycles of a test: a first pass fits each with its own, their mean is
// held in a second.
namespace mindahl::campaign {

/// @param fit    of the cycles, by which alpha must be fitted
/// @param files  that are read, each twice; none of records in memory
/// @throws InputError where alpha is held or prescribed, or a file can be read only once
void RequireThatAlphaCanBeShared(const identification::FitOptions& fit,
                                 std::span<const std::string> files);

/// Takes the exponent of a cycle that determines it.
void PoolAlpha(const CycleFit& fit, PooledValue& alpha);

/// @throws InputError where no cycle determined alpha
void RequireSharedAlpha(const PooledValue& alpha);

/// Makes "alpha 0.333 ± 0.001 shared, of 298 cycles that scatter by 0 beyond their errors, p = 0.4"
std::string SharedAlphaInWords(const PooledValue& alpha);

}  // namespace mindahl::campaign
