#pragma once

namespace mindahl::models {

/// The three parameters that all models share: the branch law
///   dT/dx = σ·(1 − T/Tc)^α, T(0) = 0   ⇒   f(x) = Tc·(1 − u),  u = [1 − (1−α)·σx/Tc]₊^{1/(1−α)}
/// Peyret et al. (2017) eq. 10 and its integral (docs/theory.md §4). α = 0 is Jenkins' element,
/// α = 1/3 Mindlin's contact, α = 1 Dahl's exponential.
struct BranchLaw {
  double tangential_stiffness = 0.0;  ///< σ [N/m], finite, > 0
  double shape_exponent = 1.0 / 3.0;  ///< α [–], >= 0, <= 100
  double slip_force = 0.0;            ///< Tc [N], finite, > 0; σ/Tc within 1e-150 … 1e150 1/m
};

/// @throws InvalidArgument naming the parameter, its value and the rule
void Validate(const BranchLaw& law);

/// Returns the law of the same contact under another load: σ·(N/N₀)^p, α, Tc·N/N₀.
/// @param load_ratio     N/N₀ [–], finite, > 0
/// @param load_exponent  p [–], finite
BranchLaw AtLoad(const BranchLaw& law, double load_ratio, double load_exponent);

/// Returns the displacement at gross slip [m]: δc = Tc/(σ(1−α)) for α < 1. Infinite for α >= 1,
/// which only approaches Tc, and where it exceeds the largest double, which no x reaches. Johnson
/// (1985) 7.42 at the limit, for α = 1/3. Relative error < 1 ε = 2.2e-16.
double GrossSlipDisplacement(const BranchLaw& law);

// The functions below take a valid law and any x but NaN, which they refuse by InvalidArgument.
// They work in long double, with y = σx/Tc in two parts, and round once. Where long double has 64
// bits or more their relative error is below 1 ε = 2.2e-16 for every α and x, also next to slip;
// what underflows is right to half the smallest denormal. With a 53-bit long double the errors of f
// stay below 4 ε, those near slip grow (docs/accuracy.md).

/// Returns f(x) [N], odd in x [m]; ±Tc at and beyond gross slip.
double BackboneForce(const BranchLaw& law, double x);

/// Returns u(x) = 1 − |f(x)|/Tc [–], the fraction of the slip force still to be mobilised; even in
/// x, exactly 0 at and beyond gross slip. The stick radius of a Mindlin contact is c/a = u^{1/3}
/// (Peyret eq. 5).
double BackboneRemaining(const BranchLaw& law, double x);

}  // namespace mindahl::models
