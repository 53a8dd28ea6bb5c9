#pragma once

#include "mindahl/methods/method.h"

namespace mindahl::methods {

// The branch law as a differential equation, dT/dx = σ(v − s(T−T₀)/(span·Tc))^α on each branch
// (Peyret et al. eqs 10, 26, 27), followed in steps. In the branch's own scale it is one equation
// for every model and branch,
//   du/dy = −u₊^α,  u(0) = 1,
// and a step of T is the same step of u. A branch that is left and taken up again goes on from
// where it was left: that is return-point memory.

Evaluator PrepareEuler(const models::FrictionModel& model, const models::BranchLaw& law,
                       const Resolution& resolution);
Evaluator PrepareRk4(const models::FrictionModel& model, const models::BranchLaw& law,
                     const Resolution& resolution);
Evaluator PrepareDopri5(const models::FrictionModel& model, const models::BranchLaw& law,
                        const Resolution& resolution);
Evaluator PrepareBackwardEuler(const models::FrictionModel& model, const models::BranchLaw& law,
                               const Resolution& resolution);
Evaluator PrepareExponential(const models::FrictionModel& model, const models::BranchLaw& law,
                             const Resolution& resolution);

void CountEuler(const models::FrictionModel& model, const models::BranchLaw& law,
                const Resolution& resolution, const Drive& drive, OperationCount& count);
void CountRk4(const models::FrictionModel& model, const models::BranchLaw& law,
              const Resolution& resolution, const Drive& drive, OperationCount& count);
void CountDopri5(const models::FrictionModel& model, const models::BranchLaw& law,
                 const Resolution& resolution, const Drive& drive, OperationCount& count);
void CountBackwardEuler(const models::FrictionModel& model, const models::BranchLaw& law,
                        const Resolution& resolution, const Drive& drive, OperationCount& count);
void CountExponential(const models::FrictionModel& model, const models::BranchLaw& law,
                      const Resolution& resolution, const Drive& drive, OperationCount& count);

}  // namespace mindahl::methods
