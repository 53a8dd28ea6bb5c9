#pragma once

#include <limits>
#include <span>

#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::models {

/// Describes a spring in series with the contact: the compliance of the rig itself. Displacements
/// are then those of both, δ = x + T/k_r with x the contact's, and T(δ) follows exactly the same
/// rules, each branch φ being composed with the spring (docs/theory.md §5).
struct SeriesSpring {
  /// k_r [N/m], > 0; infinite for a rigid rig
  double stiffness = std::numeric_limits<double>::infinity();
};

/// @throws InvalidArgument unless the stiffness is > 0, or infinite
void Validate(const SeriesSpring& rig);

/// Computes the tangential force [N] at each sample of a loading path: exact, no time step.
///   T(δ) = Tc·(t₀ + span·v·sgn(e)·φ(k|e|)),  e = δ − origin of the sample's branch
/// with t₀ the force at the branch's origin and (v, span, k) the model's BranchScale: for a Masing
/// law the sum over surviving extrema of docs/theory.md §5.
/// @param path          as from MakeLoadingPath on the same displacements, for the model's memory
/// @param displacement  [m]
/// @param force         [N], written; same size
/// @param rig           spring in series, rigid unless given
/// @throws InvalidArgument for an invalid law, sizes that differ, and for a spring that is invalid
///   or 1e100 times softer than a branch
/// The law's α is used as it stands, also for a model that prescribes one.
/// Relative error below 6 ε = 1.3e-15 on the virgin curve. After reversals the absolute error is
/// below 5e-14·Tc to 10⁵ nested reversals, whose roundings add up as in a random walk (1e-13·Tc at
/// 10⁶); closed loops leave nothing behind. |T| <= Tc. Cost: one branch law a sample and a branch,
/// and 32 bytes a branch; with a spring up to 3 iterations a sample (bench/response_bench.cc).
void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const double> displacement, std::span<double> force,
                   const SeriesSpring& rig = {});

}  // namespace mindahl::models
