#pragma once

#include <vector>

#include "identification/force_residual.h"
#include "identification/parameter_layout.h"
#include "identification/solver.h"

namespace mindahl::identification {

/// Ends of the set of parameters that the data do not tell from the best fit.
struct Range {
  double lower = 0.0;  // of θ
  double upper = 0.0;
};

/// The likelihood along the one direction in which hysteresis loops are badly determined.
///
/// Far from gross slip a loop depends on σ and α/Tc, and weakly on the rest (docs/theory.md §10):
/// the likelihood is a long curved valley along which Tc, and α with it, may change many times at
/// little cost. The Jacobian at the best fit sees its floor there and no further. So Tc is moved
/// along a grid from the peak force to twenty times it, the others fitted again from the last
/// point, and every parameter's range is collected over the points that a likelihood-ratio test
/// does not reject.
struct SlipForceProfile {
  // Not rejected where Tc is twenty times the largest force, or where α has reached its bound.
  bool open_above = false;  // not clearly rejected where Tc is twenty times the largest force
  Range slip_force;         // ln Tc
  Range shape_exponent;     // α
  Range stiffness;          // ln σ
};

/// @param critical          rejected when (SS − SS_best)/variance · effective_share exceeds this
/// @param variance          of a residual
/// @param effective_share   effective over actual samples
SlipForceProfile ProfileSlipForce(const ForceResidual& residual, const ParameterLayout& layout,
                                  const Solution& best, double variance, double effective_share,
                                  double critical, const FitOptions& options);

/// Whether a rigid contact, σ a thousand times larger, passes the same test.
bool StiffnessIsOpenAbove(const ForceResidual& residual, const ParameterLayout& layout,
                          const Solution& best, double variance, double effective_share,
                          double critical, const FitOptions& options);

}  // namespace mindahl::identification
