#pragma once

#include <cmath>
#include <span>

#include "mindahl/models/branch_law.h"

namespace mindahl::models {

/// Friction of a joint: Dahl's own law, whose force follows the load that the joint carries and
/// differs between the directions.
///
///   dz/dδ = (σ/Tc)·(1 − s·z)^α,  s = sgn δ̇;   T = Tc·(|N|·z + A·N·z²)/N̄
///
/// The memory is z alone, and depends on δ alone: a load that varies makes no element slip (that is
/// LoadDependentLaw's contact). For α = 1 this is ż = (ω − |ω|z)/h, T = μ|τ|z + μ′τz² of
/// strain-wave and cycloid drives, with h = Tc/σ, μ = Tc/N̄ and μ′ = A·μ (google-deepmind/mujoco
/// #3528).
struct JointFriction {
  BranchLaw law{};              ///< σ [N/m], α, Tc [N] under the reference load
  double reference_load = 1.0;  ///< N̄ [N], finite, > 0
  double asymmetry = 0.0;       ///< A in (−1, 1): slip forces Tc(1 ± A) under N̄
};

/// @throws InvalidArgument naming the parameter, its value and the rule
void Validate(const JointFriction& joint);

/// Returns the law of z: a ContactState of Dahl's own law with it, moved to δ, has z as its force.
/// Unit slip force, knee h = Tc/σ.
/// @throws InvalidArgument as Validate
BranchLaw LawOfState(const JointFriction& joint);

/// Returns T/Tc of the state z under N/N̄: |n|·z + A·n·z².
inline double JointForce(double state, double load_ratio, double asymmetry) {
  return state * (std::abs(load_ratio) + asymmetry * load_ratio * state);
}

/// Returns its derivative by z.
inline double JointForceSlope(double state, double load_ratio, double asymmetry) {
  return std::abs(load_ratio) + 2 * asymmetry * load_ratio * state;
}

/// Computes the force [N] at each sample: exact, no time step; z by the closed form of each branch.
/// The joint is at z = 0 at displacement 0 before the first sample.
/// @param displacement  δ [m] or [rad], within ±1e100
/// @param load          N [N] or [N m], finite, of either sign; same size
/// @param force         T, written; same size; |T| <= Tc(1 + |A|)·|N|/N̄
/// @throws InvalidArgument for an invalid law, sizes that differ and values out of range
/// Absolute error as of EvaluateForce for Dahl's own law, times (1 + 2|A|)·|N|/N̄.
void EvaluateJointFriction(const JointFriction& joint, std::span<const double> displacement,
                           std::span<const double> load, std::span<double> force);

}  // namespace mindahl::models
