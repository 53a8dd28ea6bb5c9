#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/tradeoff/approximation.h"

namespace mindahl::tradeoff {

/// Errors of a response, relative [–].
struct Precision {
  double max_force = 0.0;  ///< largest |ΔT| over the peak force
  double rms_force = 0.0;  ///< root mean square of ΔT over the peak force
  /// |ΔW/W| of the work ∫T dδ, trapezoidal; empty where the exact one is 0
  std::optional<double> energy = std::nullopt;
};

/// Compares a response with the exact one [N].
/// @throws InvalidArgument when sizes differ or there is no sample
Precision Compare(std::span<const double> exact, std::span<const double> displacement,
                  std::span<const double> force);

/// One point of a work–precision diagram.
struct WorkPrecision {
  Approximation approximation = {};
  Precision precision = {};
  double cost = 0.0;  ///< [ns/sample], of CostOf()
  /// True if no other point beats it both in cost and in the largest force error.
  bool is_on_front = false;
};

/// Runs every one of AllApproximations() along the drive, and compares each with the exact response
/// of the contact's Masing law.
/// @throws InvalidArgument for an invalid law, an empty drive or a displacement that is not finite
std::vector<WorkPrecision> MeasureWorkPrecision(const models::BranchLaw& law,
                                                const methods::Drive& drive);

/// Returns which points no other beats both in cost and in the largest force error, of equals the
/// first.
std::vector<bool> ParetoFront(std::span<const WorkPrecision> points);

/// Returns the cheapest point whose largest force error, and error of energy where that counts, is
/// within a tolerance; the first of equals: costs within a tenth of each other are equal, and
/// simpler models come first. The exact one always is within.
/// @throws InvalidArgument for a tolerance outside (0, 1]
std::size_t CheapestWithin(double tolerance, bool energy_counts,
                           std::span<const WorkPrecision> points);

}  // namespace mindahl::tradeoff
