#pragma once

#include <cstddef>
#include <vector>

#include "identification/inference/estimates.h"
#include "mindahl/identification/fit_result.h"

/// Intervals by the likelihood, where the parabola of its maximum is wrong: far from gross slip,
/// beside a rig or a parallel spring it is a long curved valley (docs/theory.md §10).
namespace mindahl::identification {

using Region = std::vector<std::vector<double>>;  // θ of fits that are not rejected

/// Returns the ends of the interval of a parameter, where F of the best fit against those with it
/// held, the others fitted again, is the critical one, to a hundredth. A parameter's own bound is
/// an end; one that only the search has, or α's, leaves it open, and a slip force of twenty times
/// the largest force that is not clearly rejected. Adds to `region` what lies on the way.
Ends Profile(const Estimates& fitted, std::size_t parameter, Region& region);

/// Makes intervals by the likelihood of those of σ, α, Tc and a fitted rig or parallel spring of
/// which the parabola may be wrong. They include every fit that is not rejected on the way to an
/// end of any. The standard error follows. Where Tc is open above, so is α.
void ProfileIntervals(const Estimates& fitted, FitResult& result);

}  // namespace mindahl::identification
