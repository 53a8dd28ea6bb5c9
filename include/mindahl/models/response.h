#pragma once

#include <cstddef>
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
///
///   T(δ) = Tc·(t₀ + span·v·sgn(e)·φ(k|e|)),  e = δ − origin of the sample's branch
///
/// with t₀ the force at the branch's origin and (v, span, k) the model's BranchScale: for a Masing
/// law the sum over surviving extrema of docs/theory.md §5.
/// @param path          as from MakeLoadingPath on the same displacements, for the model's memory
/// @param displacement  [m]
/// @param force         [N], written; same size
/// @param rig           spring in series, rigid unless given
/// @throws InvalidArgument for an invalid law, sizes that differ, or for α > 1 a displacement
/// beyond
///   1.8e200 elastic limits of a branch, where the force still grows; for a spring that is invalid
///   or 1e100 times softer than a branch
/// The law's α is used as it stands, also for a model that prescribes one.
/// Relative error below 6 ε = 1.3e-15 on the virgin curve. After reversals the absolute error is
/// below 5e-14·Tc to 10⁵ nested reversals, whose roundings add up as in a random walk (1e-13·Tc at
/// 10⁶); closed loops leave nothing behind. |T| <= Tc. Cost: one branch
/// law a sample and a branch; nothing is allocated per sample, 40 bytes per branch, and runs of one
/// branch have no data-dependent jump. With a spring the same errors, and up to 3 iterations a
/// sample (bench/response_bench.cc); none for α = 0.
void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const double> displacement, std::span<double> force,
                   const SeriesSpring& rig = {});

/// Computes the tangential displacement [m] of a contact at each sample of an imposed force: exact,
/// no time step, the inverse of EvaluateForce for a contact that starts unloaded, T = 0 at δ = 0.
///
///   δ = δᵣ + s·y(|T − Tᵣ|/(span·v·Tc))/k + T/k_r,   y(φ) = (1 − u^{1−α})/(1 − α),  u = 1 − φ
///
/// with (v, span, k) the model's BranchScale on the branch from Tᵣ. α = 1/3 on the virgin branch
/// and between ±T* are eqs 6, 8 and 9 of Peyret et al. (2017). T and δ turn together, so that
/// Madelung's rules hold of forces as they do of displacements (docs/theory.md §5).
/// @param law           its α is used as it stands, also for a model that prescribes one
/// @param force         T [N], |T| < Tc <= 1e307 N: at Tc the contact slides, and no displacement
///   belongs to the force. The force may jump: between samples it is taken to be monotone
/// @param displacement  δ [m], written; same size; within ±1e307
/// @param rig           spring in series, rigid unless given; δ is that of both
/// @throws InvalidArgument for an invalid law or spring, an empty history, sizes that differ, and
///   naming the sample for a force that is not below Tc, by more than rounding for Dahl's law, or a
///   displacement beyond 1e307 m, which α > 1 comes to before slip
/// A branch has a relative error below (6 + |1 − α|·|ln u|) ε, as T → 0 and next to slip too; for
/// Dahl's law also what a change of T by 2 ε·Tc makes. After reversals these add up. Cost: one
/// power a sample and a branch, a cubic root for α = 1/3, none for α = 0; 60 bytes a reversal.
void EvaluateDisplacement(const FrictionModel& model, const BranchLaw& law,
                          std::span<const double> force, std::span<double> displacement,
                          const SeriesSpring& rig = {});

}  // namespace mindahl::models
