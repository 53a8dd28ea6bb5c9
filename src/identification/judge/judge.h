#pragma once

#include <span>
#include <vector>

#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// Sets the verdict on each parameter, from estimates and findings alone: the worst of
///  - not identifiable without an interval, bounded below where the interval is open above;
///  - what each finding that names the parameter calls for (kFindings);
/// whatever the order of the findings (Identifiability is in the order of precedence). What the
/// user holds is identifiable. A finding that names no parameter changes none.
void Judge(std::span<ParameterEstimate> estimates, std::span<const Finding> findings);

/// Under a model that does not describe the record nothing of it is to be believed: takes back
/// errors, limits, tests, and what the findings would have one do to know its parameters better;
/// adds the finding model_inadequate. Before Judge().
FitResult WithoutInadequate(FitResult result);

}  // namespace mindahl::identification
