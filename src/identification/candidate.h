#pragma once

#include <vector>

#include "identification/force_residual.h"
#include "identification/parameter_layout.h"
#include "identification/scaled_records.h"
#include "identification/solver.h"
#include "mindahl/identification/fit.h"

namespace mindahl::identification {

/// A fit of all records from one assumption about their past.
struct Candidate {
  models::InitialState state;
  ParameterLayout layout;
  ForceResidual residual;
  Solution solution;
  std::vector<StartReport> starts;
};

/// The best of the fits from every starting point, from the past that the options name or from the
/// one that Akaike's criterion prefers.
/// @throws InvalidArgument when there are fewer samples than free parameters
Candidate FitBestState(const ScaledRecords& data, const FitOptions& options);

}  // namespace mindahl::identification
