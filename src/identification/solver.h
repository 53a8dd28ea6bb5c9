#pragma once

#include <string>
#include <vector>

#include "identification/force_residual.h"
#include "identification/parameter_layout.h"
#include "mindahl/identification/fit.h"

namespace mindahl::identification {

struct Solution {
  std::vector<double> theta;  // all parameters
  double sum_of_squares = 0.0;
  bool converged = false;
  int iterations = 0;
  std::string termination = "not run";
};

/// Least squares over the free parameters of `layout` from `start`, by Ceres' bounded
/// Levenberg-Marquardt method. The start is moved into the bounds.
Solution Solve(const ForceResidual& residual, const ParameterLayout& layout,
               std::vector<double> start, const FitOptions& options);

}  // namespace mindahl::identification
