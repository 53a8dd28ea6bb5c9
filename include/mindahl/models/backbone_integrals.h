#pragma once

#include "mindahl/models/backbone.h"

/// Integrals of the normalised branch law φ(y) (backbone.h), with y = σx/Tc >= 0 and α >= 0. In
/// long double, whose spare digits (11 bits on x86-64) are what the closed forms lose by
/// cancellation. Where long double has 53 bits they lose those of the result.
namespace mindahl::models::backbone {

/// y as the unevaluated sum of two numbers, the second below an ulp of the first: near slip
/// z = 1 − βy cancels, and the rounding of y alone would decide its digits.
struct SplitDisplacement {
  long double high = 0.0L;
  long double low = 0.0L;
};

/// Returns y = stiffness·|x|/slip_force of three doubles, to twice the digits of long double.
SplitDisplacement Normalize(double stiffness, double x, double slip_force);

/// Reduces y with z to full relative precision.
Reduced<long double> Reduce(const SplitDisplacement& y, long double shape_exponent);

/// Returns ∫₀^y φ ds = y − (1 − u^{2−α})/(2−α); → y²/2 as y → 0. Relative error below 2⁻⁵⁵ (64-bit
/// long double).
long double Work(const SplitDisplacement& y, long double shape_exponent);

/// Returns the energy lost in a closed Masing loop of amplitude y over Tc²/σ, 8∫₀^y φ ds − 4yφ(y).
/// → (2/3)·α·y³ as y → 0, where both terms cancel: there by the series
///   φ = −Σ (−y)ᵏ pₖ,  pₖ = Π_{j<k}(1 − jβ)/k!,   loop = Σ_{k>=2} (−1)ᵏ pₖ (4 − 8/(k+1)) y^{k+1}.
/// They cancel as well for α < 1/2, up to slip, and for α > 4: there as 4[2(y − φ) − αyφ]/(2−α).
/// Relative error below 2⁻⁵⁴ (64-bit long double).
long double MasingLoopEnergy(const SplitDisplacement& y, long double shape_exponent);

}  // namespace mindahl::models::backbone
