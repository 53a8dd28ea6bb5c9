#pragma once

#include <algorithm>

#include "mindahl/identification/fit_result.h"

namespace mindahl::cli {

/// Whether a fit is done, for the exit status: it converged and, where it is strict, every free
/// parameter is identifiable and the model is not inadequate.
inline bool Established(const identification::FitResult& fit, bool strict) {
  if (!fit.converged) return false;
  if (!strict) return true;
  if (fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate) return false;
  return std::ranges::all_of(fit.parameters, &identification::ParameterEstimate::is_known);
}

}  // namespace mindahl::cli
