#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

/// The branch law in normalised form, the one curve that every model here follows (docs/theory.md
/// §4).
///
///   φ(y) = 1 − u,   u = e_α(−y) = [1 − (1−α)·y]₊^{1/(1−α)},   e₁(−y) = exp(−y)
///
/// y = σx/Tc >= 0 is the displacement from the branch's origin over the elastic limit Tc/σ and φ
/// the force over Tc. With β = 1 − α, w = β·y, z = 1 − w: u = z^{1/β} and φ' = u^α = u/z. Inline
/// and free of checks: they are the inside of every kernel. Callers validate (branch_law.h).
namespace mindahl::backbone {

/// Displacements beyond this many elastic limits are taken as this many: past slip, or within
/// rounding of Tc, for α <= 1. For α > 1, which approaches Tc as y^{−1/(α−1)} only, the force stays
/// what it is there.
template <typename Real>
inline constexpr Real kLargestDisplacement = std::is_same_v<Real, float> ? Real(1e20) : Real(1e200);

/// Largest α accepted: beyond it (1−α)·y could overflow.
template <typename Real>
inline constexpr Real kLargestShapeExponent = std::is_same_v<Real, float> ? Real(1e10)
                                                                          : Real(1e100);

/// Any α >= 0. Two transcendentals a value.
template <typename Real>
struct GeneralShape {
  Real shape_exponent;

  /// z = 1 − (1−α)·y, rounded once: near slip, where it cancels, 1 − y or 1 − α is exact.
  [[nodiscard]] Real Base(Real y) const {
    return y <= 2 ? std::fma(shape_exponent, y, 1 - y) : std::fma(shape_exponent - 1, y, Real(1));
  }

  /// log u = log(z)/β; far from slip as −y·ρ(w) with ρ(w) = −log1p(−w)/w, which is smooth through α
  /// = 1 and y = 0: neither needs a series. −∞ at and beyond gross slip.
  [[nodiscard]] Real LogRemaining(Real y) const {
    y = std::min(y, kLargestDisplacement<Real>);
    const Real beta = 1 - shape_exponent;
    const Real w = beta * y;
    if (w >= Real(0.5)) return std::log(std::max(Base(y), Real(0))) / beta;
    const Real ratio = w == 0 ? Real(1) : -std::log1p(-w) / w;
    return -y * ratio;
  }

  /// u, the share of the slip force still to be mobilised.
  [[nodiscard]] Real Remaining(Real y) const { return std::exp(LogRemaining(y)); }

  /// φ(y)
  [[nodiscard]] Real Force(Real y) const { return -std::expm1(LogRemaining(y)); }

  /// φ'(y) = u^α = u/z; 0 at and beyond gross slip.
  [[nodiscard]] Real Slope(Real y) const {
    y = std::min(y, kLargestDisplacement<Real>);
    const Real z = Base(y);
    return z > 0 ? Remaining(y) / z : Real(0);
  }
};

/// α = 1/3, Mindlin: u = z·√z with z = 1 − 2y/3. A square root and a division a value.
template <typename Real>
struct MindlinShape {
  /// 1 − z√z = (1 − z³)/(1 + z√z) = w(1 + z + z²)/(1 + z√z): no cancellation as y → 0.
  [[nodiscard]] Real Force(Real y) const {
    const Real w = std::min(Real(2) / 3 * y, Real(1));
    const Real z = 1 - w;
    return w * (1 + z + z * z) / (1 + z * std::sqrt(z));
  }
};

/// α = 0, Jenkins: elastic, then perfectly plastic.
template <typename Real>
struct JenkinsShape {
  [[nodiscard]] Real Force(Real y) const { return std::min(y, Real(1)); }
};

/// Calls `visitor` with the cheapest shape that is exact for α: chosen once, outside the kernels.
template <typename Real, typename Visitor>
decltype(auto) WithShape(Real shape_exponent, Visitor&& visitor) {
  if (shape_exponent == Real(0)) return visitor(JenkinsShape<Real>{});
  if (shape_exponent == Real(1) / 3) return visitor(MindlinShape<Real>{});
  return visitor(GeneralShape<Real>{shape_exponent});
}

/// φ with its derivatives, for fitting.
template <typename Real>
struct ForceAndDerivatives {
  Real force = 0;             // φ
  Real slope = 0;             // ∂φ/∂y
  Real elastic = 0;           // y·∂φ/∂y
  Real shape_derivative = 0;  // ∂φ/∂α
};

/// q(w) = (w/(1−w) + log1p(−w))/w² = Σ (k+1)/(k+2)·wᵏ, for |w| <= 1/4 by that series.
template <typename Real>
Real ShapeDerivativeSeries(Real w) {
  Real power = 1;
  Real sum = 0;
  for (int k = 0; k < 30; ++k) {  // (1/4)³⁰ < 1e-18
    sum += power * Real(k + 1) / Real(k + 2);
    power *= w;
  }
  return sum;
}

/// ∂φ/∂α = −u·(y/z + log u)/β = −u·y²·q(w): the second form where the first cancels.
template <typename Real>
ForceAndDerivatives<Real> Differentiate(Real y, Real shape_exponent) {
  y = std::min(y, kLargestDisplacement<Real>);
  const Real beta = 1 - shape_exponent;
  const Real w = beta * y;
  const GeneralShape<Real> shape{shape_exponent};
  const Real z = shape.Base(y);
  if (z <= 0) return {.force = 1};
  const Real log_remaining = shape.LogRemaining(y);
  const Real remaining = std::exp(log_remaining);
  const Real slope = remaining / z;
  const Real shape_derivative = std::abs(w) < Real(0.25)
                                    ? remaining * y * y * ShapeDerivativeSeries(w)
                                    : (y * slope + remaining * log_remaining) / beta;
  return {-std::expm1(log_remaining), slope, y * slope, -shape_derivative};
}

}  // namespace mindahl::backbone
