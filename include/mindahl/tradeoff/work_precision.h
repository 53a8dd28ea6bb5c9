#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/methods/operations.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/tradeoff/approximation.h"

namespace mindahl::tradeoff {

/// Holds a contact's response along a drive, computed without the library's kernels: at every
/// sample the sum over the surviving extrema, T = sgn(e₀)f(|e₀|) + Σ 2·sgn(eₖ₊₁−eₖ)f(|eₖ₊₁−eₖ|/2),
/// kept by their displacements, in long double (docs/theory.md §5).
struct ReferenceResponse {
  std::vector<double> force;  ///< [N]
  double peak_force = 0.0;    ///< largest |T| [N]
};

/// @throws InvalidArgument for an invalid law, an empty drive or a displacement that is not finite
ReferenceResponse MakeReferenceResponse(const models::BranchLaw& law, const methods::Drive& drive);

/// Errors of a response, relative [–].
struct Precision {
  double max_force = 0.0;  ///< largest |ΔT| over the peak force
  double rms_force = 0.0;  ///< root mean square of ΔT over the peak force
  /// |ΔW/W| of the work ∫T dδ, trapezoidal; empty where the exact one is 0
  std::optional<double> energy = std::nullopt;
};

/// @param first  sample from which errors count
/// @throws InvalidArgument when sizes differ or `first` is not a sample
Precision Compare(const ReferenceResponse& reference, const methods::Drive& drive,
                  std::span<const double> force, std::size_t first = 0);

/// Names the norm of the error by which an approximation is judged.
enum class Criterion { kMaxForce, kRmsForce, kEnergy };

/// Returns the error that a criterion looks at; infinite where it is not known.
double ErrorBy(Criterion criterion, const Precision& precision);

/// One point of a work–precision diagram.
struct WorkPrecision {
  Approximation approximation = {};
  Precision precision = {};
  double cost = 0.0;  ///< [ns/sample], from displacement to force, of the cost model
  methods::OperationCount operations = {};  ///< operations in that sum, over the whole drive
  /// [ns/sample], the least of several runs; empty where nothing was timed
  std::optional<double> measured_cost = std::nullopt;
};

/// Assesses an approximation along a drive, not timed.
/// @param force  [N], written: the response, one a sample
/// @param first  sample from which errors count
/// @throws InvalidArgument as Prepare() and Compare()
WorkPrecision Assess(const Approximation& approximation, const models::BranchLaw& law,
                     const methods::Drive& drive, const ReferenceResponse& reference,
                     std::span<double> force, std::size_t first = 0);

/// Cost [ns/sample] that no evaluation along a drive goes below.
struct CostFloor {
  double memory = 0.0;      ///< reading a displacement and writing a force
  double arithmetic = 0.0;  ///< the same with one square root and one division between
};
/// Measures the floor as the others are measured.
CostFloor MeasureCostFloor(const methods::Drive& drive);
/// Returns the floor of the cost model.
CostFloor ModelledCostFloor();

/// Measures the cost [ns/sample] of an evaluation, the least of several runs.
/// @param force  [N], written, one a sample
/// Takes about 10 ms, or three runs where that is longer.
double MeasureCost(const methods::Evaluator& evaluate, const methods::Drive& drive,
                   std::span<double> force);

/// Runs and times every approximation along the drive, one after the other in one process.
/// @throws InvalidArgument as Prepare() and MakeReferenceResponse()
/// Takes as long as MeasureCost() for each.
std::vector<WorkPrecision> MeasureWorkPrecision(const models::BranchLaw& law,
                                                const methods::Drive& drive,
                                                std::span<const Approximation> approximations);

/// Returns which points no other beats both in cost and in error, of equals the first.
std::vector<bool> ParetoFront(std::span<const WorkPrecision> points, Criterion criterion);

}  // namespace mindahl::tradeoff
