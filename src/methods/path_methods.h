#pragma once

#include "mindahl/methods/method.h"

namespace mindahl::methods {

/// Tabulates φ between equal intervals of r = y/(1+y), which takes every y to [0, 1), linearly.
Evaluator PrepareTable(const models::FrictionModel& model, const models::BranchLaw& law,
                       const Resolution& resolution);

/// Follows each branch by the equation du/dy = −u₊^α, u(0) = 1, in the branch's own scale, in which
/// it is one for every model and branch. A branch that is left and taken up again goes on from
/// where it was left: that is return-point memory.
/// @param cost  of the steps [ns], added to; null where it is not asked for
Evaluator MakeDopri5(const models::FrictionModel& model, const models::BranchLaw& law,
                     const Resolution& resolution, double* cost);

}  // namespace mindahl::methods
