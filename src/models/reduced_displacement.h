#pragma once

#include <cmath>

/// The branch law solved for the displacement, in reduced quantities (docs/theory.md §5):
///   y(φ) = (1 − u^β)/β,  u = 1 − φ the fraction of the branch's height that is left, β = 1 − α.
namespace mindahl::models {

/// No form subtracts what cancels.
/// @param share      φ in [0, 1)
/// @param remaining  u = 1 − φ > 0, with digits of its own next to slip
inline double ReducedDisplacement(double shape_exponent, double share, double remaining) {
  if (shape_exponent == 0) return share;
  if (shape_exponent == 1.0 / 3) {
    const double root = std::cbrt(remaining);
    return 1.5 * share * (1 + root) / (1 + root + root * root);
  }
  const double log_remaining = share < 0.5 ? std::log1p(-share) : std::log(remaining);
  const double exponent = (1 - shape_exponent) * log_remaining;
  return exponent == 0 ? -log_remaining : -log_remaining * (std::expm1(exponent) / exponent);
}

/// Returns ∂y/∂α = ln²u·(1 − e^z + z·e^z)/z², z = β·ln u; the last factor by its series,
/// Σ (k+1)·zᵏ/(k+2)!, where its terms cancel.
/// @param log_remaining  ln u
inline double ReducedDisplacementPerShape(double shape_exponent, double log_remaining) {
  const double z = (1 - shape_exponent) * log_remaining;
  constexpr double kCancelling = 0.05;  // beyond it the ninth term is above ε/8 of the first
  double factor = 0.0;
  if (std::abs(z) < kCancelling) {
    factor =
        1.0 / 2 +
        z * (1.0 / 3 +
             z * (1.0 / 8 +
                  z * (1.0 / 30 +
                       z * (1.0 / 144 + z * (1.0 / 840 + z * (1.0 / 5760 + z * (1.0 / 45360 +
                                                                                z / 403200.0)))))));
  } else {
    factor = (z * std::exp(z) - std::expm1(z)) / (z * z);
  }
  return log_remaining * log_remaining * factor;
}

}  // namespace mindahl::models
