#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mindahl/methods/method.h"
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

/// Amplitudes over the gross-slip displacement at which a model errs by no more than a tolerance.
struct LambdaRange {
  double from = 0.0;  ///< the least studied where it goes on below
  double to = 0.0;    ///< the greatest studied where it goes on above
};

/// Holds the range in which one model is good enough in one cycle of a steady drive.
struct ModelRegion {
  std::string model;
  std::size_t cycle = 1;                       ///< from 1, the virgin loading being the first
  Criterion criterion = Criterion::kMaxForce;  ///< or kEnergy, that lost in the cycle
  double tolerance = 0.0;                      ///< relative to T* or to the energy [–]
  std::vector<LambdaRange> ranges;             ///< ascending, none where it is nowhere
};

struct ModelRegionOptions {
  std::vector<double> tolerances = {0.001, 0.01, 0.05};
  std::size_t cycles = 5;  ///< >= 1
  double least_lambda = 1e-4;
  double greatest_lambda = 1e6;
};

/// Regions of every model of ModelLadder, in exact closed form, against the Masing law, at the same
/// σ and Tc, and the same α where the model prescribes none. Errors do not depend on the sampling:
/// samples lie evenly, 150 of them, within twice the gross-slip displacement of each reversal,
/// where branches are curved. Bounds of a range are found to 0.2 %; a range narrower than a twelfth
/// of a decade may be missed.
/// @param law  α < 1, since λ counts gross-slip displacements
/// @throws InvalidArgument for an invalid law, α >= 1 or options out of range
/// Takes about a second and 30 MB with the options' defaults.
std::vector<ModelRegion> FindModelRegions(const models::BranchLaw& law,
                                          const ModelRegionOptions& options = {});

}  // namespace mindahl::tradeoff
