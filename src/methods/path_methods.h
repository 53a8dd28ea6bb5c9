#pragma once

#include "mindahl/methods/method.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::methods {

/// Returns the branch law of an exponent, by what it is made of.
inline Operation LawOperation(double shape_exponent) {
  if (shape_exponent == 0) return Operation::kLinear;
  return shape_exponent == 1.0 / 3 ? Operation::kRoot : Operation::kPower;
}

/// Adds what finding the branches takes, and opening them.
inline models::LoadingPath CountPath(const models::FrictionModel& model, const Drive& drive,
                                     OperationCount& count) {
  models::LoadingPath path = MakeDrivePath(model, drive);
  count.Add(Operation::kPlace, static_cast<double>(drive.displacement.size()));
  count.Add(Operation::kReversal, static_cast<double>(path.branches.size()));
  return path;
}

/// Tabulates φ between equal intervals of r = y/(1+y), which takes every y to [0, 1), linearly.
Evaluator PrepareTable(const models::FrictionModel& model, const models::BranchLaw& law,
                       const Resolution& resolution);
void CountTable(const models::FrictionModel& model, const models::BranchLaw& law,
                const Resolution& resolution, const Drive& drive, OperationCount& count);

// The branch law as a differential equation, dT/dx = σ(v − s(T−T₀)/(span·Tc))^α on each branch
// (Peyret et al. eqs 10, 26, 27), followed in steps. In the branch's own scale it is one equation
// for every model and branch,
//   du/dy = −u₊^α,  u(0) = 1,
// and a step of T is the same step of u. A branch that is left and taken up again goes on from
// where it was left: that is return-point memory.

/// Makes an evaluator of a method in steps, which counts what it does where that is asked for.
/// @param count  null where nothing is to be counted
using StepMethod = Evaluator (*)(const models::FrictionModel& model, const models::BranchLaw& law,
                                 const Resolution& resolution, OperationCount* count);

Evaluator MakeEuler(const models::FrictionModel& model, const models::BranchLaw& law,
                    const Resolution& resolution, OperationCount* count);
Evaluator MakeRk4(const models::FrictionModel& model, const models::BranchLaw& law,
                  const Resolution& resolution, OperationCount* count);
Evaluator MakeDopri5(const models::FrictionModel& model, const models::BranchLaw& law,
                     const Resolution& resolution, OperationCount* count);
Evaluator MakeBackwardEuler(const models::FrictionModel& model, const models::BranchLaw& law,
                            const Resolution& resolution, OperationCount* count);
Evaluator MakeExponential(const models::FrictionModel& model, const models::BranchLaw& law,
                          const Resolution& resolution, OperationCount* count);

}  // namespace mindahl::methods
