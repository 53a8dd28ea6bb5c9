#pragma once

#include <string>

#include "identification/candidate.h"
#include "identification/slip_force_profile.h"
#include "identification/uncertainty.h"
#include "mindahl/identification/fit.h"

namespace mindahl::identification {

void Warn(FitResult& result, std::string code, std::string message);

/// Names the parameters on which, alone or combined, the record does not depend.
void JudgeNullDirections(FitResult& result, const Candidate& candidate,
                         const LocalUncertainty& local);

/// Puts what the profile found into intervals, verdicts and words.
/// @param quantile  half width of a 95 % interval in standard errors
void JudgeProfile(FitResult& result, const ParameterLayout& layout, const SlipForceProfile& profile,
                  double quantile);

void JudgeStiffness(FitResult& result, bool open_above);

/// Calls a parameter not identifiable whose 95 % interval is too wide to be of use.
void JudgeIntervals(FitResult& result);

}  // namespace mindahl::identification
