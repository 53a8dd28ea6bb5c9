#pragma once

#include <span>

#include "mindahl/models/branch_law.h"

namespace mindahl::models {

/// Friction under a normal load N that varies along the path.
///
/// The contact is a set of elements in parallel (docs/theory.md §11): element h is in contact while
/// δc(N) > h, sticks elastically, and slips at |δ − r| = δc(N) − h, with r the displacement at
/// which it carries nothing. With
///   Tc(N) = μN,   σ(N) = σ_ref·(N/N_ref)^α,   δc(N) = Tc/(σ(1−α)) ∝ N^{1−α}
/// the elements of σ(h) add up at constant N to the branch law and its Masing loops, and for
/// α = 1/3 to the Hertz contact of Mindlin & Deresiewicz (1953) under any N(t) and δ(t), as far as
/// Cattaneo's and Mindlin's assumptions go (Jäger 1993, Ciavarella 1998). α alone says how the
/// stiffness follows the load: a circular contact has σ ∝ a ∝ N^{1/3}, a flat punch (α = 0) a
/// constant σ, a cone (α = 1/2) σ ∝ √N.
struct LoadDependentLaw {
  double friction_coefficient = 0.0;  ///< μ [–], finite, > 0
  double reference_load = 0.0;        ///< N_ref [N], finite, > 0
  double reference_stiffness = 0.0;   ///< σ_ref [N/m], at the reference load, finite, > 0
  double shape_exponent = 1.0 / 3.0;  ///< α [–], >= 0, < 1: slip is complete at a finite δc
};

/// @throws InvalidArgument naming the parameter, its value and the rule, also where the branch law
/// at the reference load is invalid
void Validate(const LoadDependentLaw& law);

/// Returns the branch law that holds while N stays constant.
///   σ = σ_ref·(N/N_ref)^α, α, Tc = μN
/// @param normal_load  N [N], finite, > 0
/// @throws InvalidArgument for an invalid law or load, and where the result is no valid branch law
/// Relative error of σ below 4 ε, of Tc below 1 ε.
BranchLaw BranchLawAtLoad(const LoadDependentLaw& law, double normal_load);

/// Computes the tangential force [N] at each sample: no time step, exact for a path that runs
/// straight in (δ, δc(N)) from sample to sample, which for samples of a smooth path leaves an error
/// of second order in their spacing, slipping or not.
///   T = Σ r'·[Tc(h₂) − Tc(h₁)]   over zones (h₁, h₂) of elements whose r(h) is a straight line
/// A sample where |Δδ| <= Δδc sticks everywhere and adds the zone Δδ/Δδc at the rim; any other
/// makes a zone ±1 at the rim, that slips, and forgets what it covers (Madelung's rules, where N is
/// constant). docs/theory.md §11 derives it.
///
/// The contact is unloaded (T = 0) at displacement 0 under the first load, before the first sample.
/// At N = 0 it is lifted off: T = 0, and nothing is remembered.
/// @param displacement  δ [m], within ±1e307
/// @param normal_load   N [N], finite, >= 0; same size
/// @param force         T [N], written; same size; |T| <= μN
/// @throws InvalidArgument for an invalid law, sizes that differ, and naming the sample for a
///   displacement or a load out of range
/// Error below 8 ε·(σ·max|δ| + Tc/(1−α)), with the largest σ and Tc of the path. Cost: amortised
/// one branch law a sample and, where N changes, one power; 40 bytes a remembered zone.
void EvaluateForceUnderLoad(const LoadDependentLaw& law, std::span<const double> displacement,
                            std::span<const double> normal_load, std::span<double> force);

}  // namespace mindahl::models
