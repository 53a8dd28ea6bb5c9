#pragma once

#include <cstddef>
#include <utility>
#include <vector>

/// The friction laws along a displacement history, as slowly and as literally as they are defined,
/// for any number type. Shares nothing with the library: it is what the library is checked against.
namespace reference {

template <typename Real>
struct Law {
  Real stiffness;   // σ [N/m]
  Real exponent;    // α [–]
  Real slip_force;  // Tc [N]
};

/// x^e for x >= 0, where x may be 0.
template <typename Real>
Real PositivePower(const Real& x, const Real& e) {
  return x <= 0 ? Real(0) : Real(exp(e * log(x)));
}

/// f(x), x >= 0: the solution of dT/dx = σ(1 − T/Tc)^α, T(0) = 0.
template <typename Real>
Real Backbone(const Law<Real>& law, const Real& x) {
  const Real y = law.stiffness * x / law.slip_force;
  const Real beta = 1 - law.exponent;
  if (beta == 0) return law.slip_force * (1 - exp(-y));
  const Real base = 1 - beta * y;
  return law.slip_force * (1 - PositivePower(base, Real(1 / beta)));
}

/// The extrema that the contact remembers at the last of `displacement` (unloaded at 0):
/// e₀ the last point of largest |δ|, e₁ the last point farthest from e₀ after it, e₂ the last point
/// farthest from e₁ after that, … up to the present point. "Last" is the rule that a branch which
/// just reaches an earlier extremum, or its mirror image, closes the loop.
template <typename Real>
std::vector<Real> DominantExtrema(const std::vector<Real>& displacement) {
  std::vector<Real> extrema;
  Real from = 0;
  std::size_t begin = 0;
  while (begin < displacement.size()) {
    std::size_t farthest = begin;
    for (std::size_t i = begin; i < displacement.size(); ++i) {
      if (abs(displacement[i] - from) >= abs(displacement[farthest] - from)) farthest = i;
    }
    from = displacement[farthest];
    extrema.push_back(from);
    begin = farthest + 1;
  }
  return extrema;
}

/// T = sgn(e₀)·f(|e₀|) + Σ 2·sgn(eₖ₊₁ − eₖ)·f(|eₖ₊₁ − eₖ|/2) over the dominant extrema, at the last
/// of `displacement`. The whole past is searched for every sample.
template <typename Real>
Real MasingForce(const Law<Real>& law, const std::vector<Real>& displacement) {
  Real force = 0;
  Real from = 0;
  bool virgin = true;
  for (const Real& extremum : DominantExtrema(displacement)) {
    const Real span = virgin ? 1 : 2;
    const Real step = extremum - from;
    const Real size = span * Backbone(law, Real(abs(step) / span));
    force += step < 0 ? Real(-size) : size;
    from = extremum;
    virgin = false;
  }
  return force;
}

/// v after a further |Δx| of dv/dx = −rate·v^α from v₀ >= 0.
template <typename Real>
Real Decay(const Real& v0, const Real& travel, const Real& exponent) {
  if (v0 <= 0) return Real(0);
  const Real beta = 1 - exponent;
  if (beta == 0) return v0 * exp(-travel);
  const Real base = PositivePower(v0, beta) - beta * travel;
  return PositivePower(base, Real(1 / beta));
}

/// Dahl's law dT/dx = σ(1 − sT/Tc)^α, s = sgn ẋ, after a step of the displacement from force T₀.
template <typename Real>
Real DahlStep(const Law<Real>& law, const Real& force, const Real& step) {
  const Real s = step < 0 ? -1 : 1;
  const Real travel = law.stiffness * abs(step) / law.slip_force;
  return s * law.slip_force *
         (1 - Decay(Real(1 - s * force / law.slip_force), travel, law.exponent));
}

/// Simplified-Dahl dT/dx = σ(1 − (T* + sT)/2Tc)^α after a step of the displacement from force T₀.
/// Where T* + sT >= 2Tc already, the force stays.
template <typename Real>
Real SimplifiedDahlStep(const Law<Real>& law, const Real& peak, const Real& force,
                        const Real& step) {
  const Real s = step < 0 ? -1 : 1;
  const Real travel = law.stiffness * abs(step) / (2 * law.slip_force);
  const Real before = 1 - (peak + s * force) / (2 * law.slip_force);
  if (before <= 0 || step == 0) return force;
  return s * (2 * law.slip_force * (1 - Decay(before, travel, law.exponent)) - peak);
}

}  // namespace reference
