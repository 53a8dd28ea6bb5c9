#pragma once

#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// True if the fit found parameters.
inline bool IsFitted(const FitResult& fit) { return !fit.parameters.empty(); }

/// Gives the options the initial states that a fit found.
inline void HoldInitialStates(const FitResult& fit, FitOptions& options) {
  options.initial_states.clear();
  for (const RecordFit& record : fit.records) {
    options.initial_states.push_back(record.initial_state);
  }
}

/// Gives the options the values that a fit found, for a search to begin with.
inline void StartFrom(const FitResult& fit, FitOptions& options) {
  for (const ParameterEstimate& parameter : fit.parameters) {
    if (parameter.status != ParameterStatus::kFixed) {
      options.start[parameter.name] = parameter.value;
    }
  }
}

}  // namespace mindahl::identification
