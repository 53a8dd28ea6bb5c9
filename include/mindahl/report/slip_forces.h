#pragma once

#include <optional>

#include "mindahl/identification/fit.h"

namespace mindahl::report {

/// The force [N] at which a contact slips in one direction of the motion; without an error or an
/// interval where the fit leaves them open or holds both of what it follows from.
struct SlipForce {
  double value = 0.0;
  std::optional<double> standard_error = {};
  std::optional<double> lower95 = {};
  std::optional<double> upper95 = {};
};

struct SlipForces {
  SlipForce positive;  ///< Tc(1 + a) [N], for motion towards positive displacement
  SlipForce negative;  ///< Tc(1 − a) [N]
};

/// Returns the slip forces of a contact whose two differ, from its `slip_force` Tc and `asymmetry`
/// a; empty where the fit has none, or leaves either of the two open.
///   var ln Tc± = var ln Tc + var a/(1 ± a)² ± 2·cov(ln Tc, a)/(1 ± a)
/// Ends of the intervals are put together alike from the ways of Tc's and a's to the estimate, so
/// that what widens theirs widens these.
std::optional<SlipForces> DescribeSlipForces(const identification::FitResult& fit);

}  // namespace mindahl::report
