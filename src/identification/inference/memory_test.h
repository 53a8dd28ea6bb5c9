#pragma once

#include <Eigen/Dense>

#include "identification/inference/local.h"
#include "identification/inference/noise.h"
#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// A law that was fitted: its Jacobian by all free parameters and its weighted residuals.
struct FittedLaw {
  const Problem* problem;
  const Solution* solution;
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
};

/// True if branches may be copies of each other: an imposed displacement, a constant load, no lag
/// and no load series.
bool CanCompareBranches(const Problem& problem);

/// Compares branches with each other, under each law with a free shape: the differences that
/// are left are held against the noise (ColumnTest).
/// @param masing  with Masing's memory
/// @param dahl    with Dahl's; null where the two are one curve
MemoryTest TestMemory(const FittedLaw& masing, const FittedLaw* dahl, const Noise& noise,
                      const DisplacementEffect& displacement, const Thresholds& thresholds,
                      Response& response);

/// @param p_value       that noise makes the discrepancy from Masing's memory
/// @param dahl_p_value  likewise
MemoryVerdict VerdictOf(double p_value, double dahl_p_value, const Thresholds& thresholds);

}  // namespace mindahl::identification
