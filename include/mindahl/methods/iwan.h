#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mindahl/models/branch_law.h"

namespace mindahl::methods {

/// Jenkins elements in parallel, Iwan (1966): springs each with a Coulomb slider, in the order in
/// which they slip.
struct IwanElements {
  std::vector<double> stiffness;   ///< [N/m], sum σ
  std::vector<double> slip_force;  ///< [N], sum Tc

  [[nodiscard]] std::size_t size() const { return stiffness.size(); }
};

/// Makes elements whose virgin curve is the polygon of tangents to f at u₀ = 1 > u₁ > … > uₙ = 0:
///   stiffness kᵢ = σ(uᵢ₋₁^α − uᵢ^α),  slip force Tc(Fᵢ − Fᵢ₋₁),  F(u) = (f − xf')/Tc
/// so that the stiffness at rest and the slip force are those of the law. Between tangents a short
/// distance h apart the polygon lies |f''|h²/8 above f. Errors even out where √|f''|·dx is
/// constant, which is √uᵢ = 1 − i/n for every α (φ'' = −αu^{2α−1}, dy = −u^{−α}du), and leaves
/// Tc·α/(2n²) to leading order in 1/n. At the last corner, next to slip, it is Tc·α^{1/(1−α)}/n²,
/// which is the more for α < 1/2: 0.192 against 0.167 for Mindlin. A reversal doubles these; those
/// of reversals that are remembered add up. α = 0 is one element, exact.
/// @param elements  >= 1
/// @throws InvalidArgument for an invalid law or no element
IwanElements MakeIwanElements(const models::BranchLaw& law, std::size_t elements);

/// Computes the force [N] along a displacement [m] of elements unloaded at 0: each keeps its force
/// as its memory.
/// @throws InvalidArgument when sizes differ or a displacement is not finite
/// Cost: one multiply, add and clamp an element and sample, vectorised.
void EvaluateIwanForce(const IwanElements& elements, std::span<const double> displacement,
                       std::span<double> force);

}  // namespace mindahl::methods
