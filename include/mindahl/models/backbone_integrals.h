#pragma once

/// Integrals of the normalised branch law φ(y) (backbone.h), with y = σx/Tc >= 0 and α >= 0. In
/// long double, whose spare digits (11 bits on x86-64) are what the closed forms lose by
/// cancellation.
namespace mindahl::backbone {

/// ∫₀^y φ ds = y − (1 − u^{2−α})/(2−α); → y²/2 as y → 0.
long double Work(long double y, long double shape_exponent);

/// Energy lost in a closed Masing loop of amplitude y, over Tc²/σ:  8∫₀^y φ ds − 4yφ(y).
/// → (2/3)·α·y³ as y → 0, where both terms cancel: there by the series
///   φ = −Σ (−y)ᵏ pₖ,  pₖ = Π_{j<k}(1 − jβ)/k!,   loop = Σ_{k>=2} (−1)ᵏ pₖ (4 − 8/(k+1)) y^{k+1}.
/// They cancel as well for small α, up to slip: there as 4[2(y − φ) − αyφ]/(2−α).
long double MasingLoopEnergy(long double y, long double shape_exponent);

}  // namespace mindahl::backbone
