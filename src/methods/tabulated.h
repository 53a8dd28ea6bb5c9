#pragma once

#include "mindahl/methods/method.h"

namespace mindahl::methods {

/// Tabulates φ between equal intervals of r = y/(1+y), which takes every y to [0, 1), linearly.
Evaluator PrepareTable(const models::FrictionModel& model, const models::BranchLaw& law,
                       const Resolution& resolution);
void CountTable(const models::FrictionModel& model, const models::BranchLaw& law,
                const Resolution& resolution, const Drive& drive, OperationCount& count);

}  // namespace mindahl::methods
