#pragma once

namespace mindahl::models {

/// Elements from `inner` outward, to the next zone or the rim, whose rest positions lie on the
/// line r(h) = intercept + slope·h (docs/theory.md §11). Real is double, or has derivatives.
template <typename Real>
struct LoadZone {
  Real inner{};       ///< h₁ [m]
  Real slope{};       ///< r' [–], within ±1; ±1 where the last slip was in that direction
  Real intercept{};   ///< r(0) [m], of the line
  Real force{};       ///< Σ r'·ΔTc [N] over the zones within
  Real slip_force{};  ///< Tc(h₁) [N]

  [[nodiscard]] Real RestAt(const Real& h) const { return intercept + slope * h; }
};

/// The rim of the contact under a load.
template <typename Real>
struct LoadRim {
  Real slip_displacement{};  ///< δc(N) [m], of the outermost elements
  Real slip_force{};         ///< Tc(N) [N]
};

}  // namespace mindahl::models
