#pragma once

#include <vector>

#include "mindahl/report/load_series.h"

namespace mindahl::report {

/// True if a value that was given is an exponent, as written with three digits.
bool IsHeldAt(double given, double exponent);

/// Returns the laws of the load that a series does not reject, each held over all loads:
///
/// p is held by projection. Of θ = (ln σ, p, α) with covariance C, and a theory that is g = cᵀθ − d
/// = 0, the estimate with it is
///   θ − C·c·g/(cᵀCc),   with covariance C − C·c·cᵀC/(cᵀCc)
/// the least change by the errors of θ: generalised least squares under a constraint, of which a
/// fit with p held is the same to first order. It is uncorrelated with g, on which the theory is
/// tested: what is tenable is not biased by having been tested.
///
/// An interval is Student's of ln σ, wider by as much as causes, profiles or another past make that
/// of σ and, as far as it moves σ, that of p. What follows is a power of σ and of inputs, whose
/// uncertainties count as normal.
/// @param hypotheses  of the same fit
/// @param known       of the contact
std::vector<LoadLaw> TenableLaws(const identification::FitResult& fit,
                                 const std::vector<LoadHypothesis>& hypotheses,
                                 const contact::KnownContact& known);

}  // namespace mindahl::report
