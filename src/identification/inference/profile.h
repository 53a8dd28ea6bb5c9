#pragma once

#include <cstddef>
#include <span>

#include "identification/inference/estimates.h"
#include "identification/intervals.h"
#include "identification/solve/search.h"
#include "mindahl/identification/fit_result.h"

/// Intervals by the likelihood, where the parabola of its maximum is wrong.
///
/// Far from gross slip a loop depends on σ and α/Tc, and weakly on the rest (docs/theory.md §10):
/// the likelihood is a long curved valley along which Tc, and α with it, may change many times at
/// little cost. The Jacobian at the best fit sees its floor there and no further. Beside a rig σ, α
/// and k share another, which bends towards the rigid rig.
namespace mindahl::identification {

/// True if the parabola may be wrong along a parameter: where it or the law is at a bound, where it
/// is badly known, and where the likelihood at the ends of the parabola's interval is another one.
bool NeedsProfile(const FittedProblem& fitted, std::size_t parameter, const FitOptions& options,
                  SearchBuffers& buffers);

/// True if the parabola's interval of a logarithm, or of α, is too wide for a parabola.
bool IsBadlyKnown(const FittedProblem& fitted, std::size_t parameter, const Thresholds& thresholds);

/// Returns the ends of the interval of a parameter, where F of the best fit against those with it
/// held, the others fitted again, is the critical one, to a hundredth. A parameter's own bound is
/// an end; one that only the search has, or α's, leaves it open, and a slip force of twenty times
/// the largest force that is not clearly rejected.
Ends Profile(const FittedProblem& fitted, std::size_t parameter, const FitOptions& options,
             SearchBuffers& buffers);

/// Returns the estimates with the intervals of some of σ, α, Tc and a fitted rig by the likelihood;
/// a standard error that was too small follows. Where Tc is open above, so is α.
ParameterEstimates WithProfiles(const FittedProblem& fitted, std::span<const std::size_t> profiled,
                                const FitOptions& options, SearchBuffers& buffers,
                                ParameterEstimates parameters);

/// Returns Tc, a limit of which is no less than the force that the contact is seen to carry, unless
/// the fit is too poor to say.
ParameterEstimate KeepAboveCarriedForce(const Problem& problem, const FitResult& result);

}  // namespace mindahl::identification
