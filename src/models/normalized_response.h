#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

/// Numbers the parameters on which t = T/Tc depends: ln κ, α, δ₀, ln c, and the asymmetry a of slip
/// forces Tc(1 ± a).
enum ResponseParameter : int { kRate, kShape, kUnloaded, kSpring, kAsymmetry, kParameters };
using Gradient = Eigen::Vector<double, kParameters>;

/// Derivatives of t by each ResponseParameter, a column each; an empty one is not wanted.
using NormalizedGradient = std::array<std::span<double>, kParameters>;

/// Holds the derivatives of a branch.
struct BranchGradient {
  Gradient force = Gradient::Zero();
  Gradient height = Gradient::Zero();
  Gradient log_rate = Gradient::Zero();
  double origin_per_unloaded = 0.0;  // 1 on the virgin curve, which moves with δ₀
  /// True of a virgin curve that is run both ways, on which a larger limit on one side is a smaller
  /// one on the other: ∂height/∂a has the sign of e there.
  bool runs_both_ways = false;
};

/// True if no derivative is wanted.
template <std::size_t kColumns>
bool IsEmpty(const std::array<std::span<double>, kColumns>& gradient) {
  return std::ranges::all_of(gradient, &std::span<double>::empty);
}

/// Computes EvaluateForce (response.h has the equations) over Tc, and its gradient in closed form,
/// for solvers. Tc itself and all other linear terms are the caller's. Where the law has a corner
/// (α = 0 at slip) the derivatives are those of the slipping side.
/// @param path      as from MakeLoadingPath on the same displacements, for the model's memory
/// @param t         written, of the same size
/// @param gradient  columns of the same size, or empty
/// @throws InvalidArgument as EvaluateForce
/// On the virgin curve the error is below 6 ε of the force, and below 32 ε of 1, by δ₀ of κ, to
/// what a change of δ by 4 ε would make: for α < 1/2 the slope varies without bound next to slip.
void EvaluateNormalizedForce(const FrictionModel& model, const NormalizedLaw& law,
                             const LoadingPath& path, std::span<const double> displacement,
                             std::span<double> t, const NormalizedGradient& gradient = {});

/// Holds the parameters on which a displacement over Tc/σ depends along a path of forces: the
/// displacement itself is linear in the compliance 1/σ.
struct ForcedLaw {
  double slip_force = 0.0;            ///< Tc [N], finite, > 0
  double shape_exponent = 1.0 / 3.0;  ///< α [–], finite, >= 0
};

/// Derivatives of d = σδ/Tc by −ln Tc, α and T₀ [1/N] of a virgin contact, a column each; an empty
/// one is not wanted.
using DisplacementGradient = std::array<std::span<double>, 3>;

/// Computes the inverse of EvaluateNormalizedForce: d = σδ/Tc, from where the contact is unloaded,
/// of a contact whose force is imposed, and its gradient, for solvers. T and δ turn together, so
/// that Madelung's rules hold of forces as they do of displacements (docs/theory.md §5). On a
/// branch from the reading T_r, which is where the force without its offset is t_r·Tc,
///   d = d_r + s·m·v^β·y(φ),   φ = |T − T_r|/(m·v·Tc),   v = 1, or 1 − s·t_r of Dahl's own law
/// m = 1 on the virgin branch, 2 after a reversal (1 of Dahl's own law).
/// @param path      as from MakeLoadingPath on the same forces, for the model's memory
/// @param force     [N], its offset included
/// @param d         written, of the same size
/// @param gradient  columns of the same size, or empty
/// @returns false where a force is at slip or beyond: no displacement belongs to it, and d holds
///   nothing of use from the first of these samples on, where it is not finite
/// @throws InvalidArgument for sizes that differ
/// A branch has a relative error below (6 + |1 − α|·|ln u|) ε. Cost: three powers a sample with the
/// gradient.
bool EvaluateNormalizedDisplacement(const FrictionModel& model, const ForcedLaw& law,
                                    const LoadingPath& path, std::span<const double> force,
                                    std::span<double> d, const DisplacementGradient& gradient = {});

// The branch law at many displacements at once, for fits: the same arithmetic for every sample,
// without a jump or a call, so that the compiler makes vectors of it. The widest instruction set
// that the processor has is chosen at the first call; they differ in roundings only.
//
// Errors: φ relative 4 ε, as in backbone.h; derivatives 4 ε of 1 and, next to slip, those of a
// displacement that is off by ε, which for α < 1/2 bends φ' without bound: they steer a solver.

/// Computes t of the samples of one run, `limit` being the largest |t|.
void EvaluateGeneralRun(const ScaledBranch& branch, double shape_exponent, double limit,
                        std::span<const double> displacement, std::span<double> t);

/// Computes t and its derivatives; a column of `gradient` that is empty is not wanted.
void DifferentiateGeneralRun(const ScaledBranch& branch, const BranchGradient& branch_gradient,
                             double shape_exponent, double limit,
                             std::span<const double> displacement, std::span<double> t,
                             const NormalizedGradient& gradient);

}  // namespace mindahl::models
