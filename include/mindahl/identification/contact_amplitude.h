#pragma once

#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// Returns the amplitude of the contact itself [m] in a steady loop of the measured amplitude: less
/// half of a gap before it, and what a rig in series takes.
/// @param law  of the record
double ContactAmplitude(const FitResult& fit, const models::BranchLaw& law, double amplitude);

/// Returns the amplitude [m] behind a gap, where the fit has one.
double AmplitudeBehindGap(const FitResult& fit, double amplitude);

}  // namespace mindahl::identification
