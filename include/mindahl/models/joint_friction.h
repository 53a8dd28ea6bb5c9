#pragma once

#include <cmath>

namespace mindahl::models {

// Friction of a joint: Dahl's own law, whose force follows the load that the joint carries and
// differs between the directions.
//   dz/dδ = (σ/Tc)·(1 − s·z)^α,  s = sgn δ̇;   T = Tc·(|N|·z + A·N·z²)/N̄
// with slip forces Tc(1 ± A) under N̄, A in (−1, 1). The memory is z alone, and depends on δ alone:
// a load that varies makes no element slip (as in docs/theory.md §11). z is the force of
// a ContactState of "dahl" with the law {σ/Tc, α, 1}. For α = 1 this is ż = (ω − |ω|z)/h,
// T = μ|τ|z + μ′τz² of strain-wave and cycloid drives, with h = Tc/σ, μ = Tc/N̄ and μ′ = A·μ
// (google-deepmind/mujoco #3528).

/// Returns T/Tc of the state z under N/N̄: |n|·z + A·n·z².
inline double JointForce(double state, double load_ratio, double asymmetry) {
  return state * (std::abs(load_ratio) + asymmetry * load_ratio * state);
}

/// Returns its derivative by z.
inline double JointForceSlope(double state, double load_ratio, double asymmetry) {
  return std::abs(load_ratio) + 2 * asymmetry * load_ratio * state;
}

}  // namespace mindahl::models
