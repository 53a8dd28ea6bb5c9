#pragma once

#include <algorithm>
#include <cstddef>

#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// Counts the fitted parameters, for criteria: those not held, and turning points.
inline std::size_t CountFreeParameters(const FitResult& fit) {
  auto count = static_cast<std::size_t>(
      std::ranges::count_if(fit.parameters, [](const ParameterEstimate& parameter) {
        return parameter.status != ParameterStatus::kFixed;
      }));
  for (const RecordFit& record : fit.records) count += record.overshoot.size();
  return count;
}

}  // namespace mindahl::identification
