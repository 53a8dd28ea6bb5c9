#pragma once

#include "mindahl/methods/method.h"
#include "mindahl/methods/operations.h"
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

}  // namespace mindahl::methods
