#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

/// The branch law in normalised form, the one curve that every model here follows (docs/theory.md
/// §4).
///
///   φ(y) = 1 − u,   u = e_α(−y) = [1 − (1−α)·y]₊^{1/(1−α)},   e₁(−y) = exp(−y)
///
/// y = σx/Tc >= 0 is the displacement from the branch's origin over the elastic limit Tc/σ and φ
/// the force over Tc. With β = 1 − α, w = β·y, z = 1 − w: u = z^{1/β} and φ' = u^α = u/z. Inline
/// and free of checks: they are the inside of every kernel. Callers validate (branch_law.h), and
/// keep y to kLargestDisplacement. Nothing here raises the invalid, overflow or division-by-zero
/// flag of floating-point arithmetic.
///
/// Errors, in ε = numeric_limits<Real>::epsilon(): φ relative 4 ε; u, φ' and the derivatives 4 ε of
/// 1 (docs/accuracy.md).
namespace mindahl::backbone {

/// Largest α accepted: beyond it (1−α)·y could overflow.
template <typename Real>
inline constexpr Real kLargestShapeExponent = std::numeric_limits<Real>::max_exponent10 < 300
                                                  ? Real(1e10)
                                                  : Real(1e100);

/// Largest y: 3e20 in single precision, 1e200 in double. For α <= 1 the force is Tc there.
template <typename Real>
inline constexpr Real kLargestDisplacement = std::numeric_limits<Real>::max() /
                                             (kLargestShapeExponent<Real> * Real(1e8));

/// The largest |x| that y = rate·|x| may be formed from.
template <typename Real>
[[nodiscard]] Real Reach(Real rate) {
  constexpr Real kLargest = std::numeric_limits<Real>::max();
  constexpr Real kUnlimited = kLargestDisplacement<Real> / kLargest;
  return rate > kUnlimited ? kLargestDisplacement<Real> / rate : kLargest;
}

/// A displacement as the branch law uses it.
template <typename Real>
struct Reduced {
  Real y;
  Real w;  ///< β·y
  Real z;  ///< 1 − w to full relative precision, also near slip; <= 0 at and beyond it
};

/// Series in s = w/(2 − w), by which −w = expm1(log1p(−w)) meets atanh: log1p(−w) = −2·atanh(s).
///   P = Σ s²ᵏ/(2k+3),   −log1p(−w)/w = 1 + s + (1+s)·s²·P
///   (w/(1−w) + log1p(−w))/w² = ½(1+s)²·[1/(1−s) − s·P]
/// For |w| < kSmall, |s| < 1/7: the first term left out is below ε/8 of either sum.
template <typename Real>
struct SmallSeries {
  static constexpr Real kSmall = Real(0.25);
  static constexpr std::size_t kTerms = std::numeric_limits<Real>::digits <= 24   ? 4
                                        : std::numeric_limits<Real>::digits <= 53 ? 9
                                        : std::numeric_limits<Real>::digits <= 64 ? 11
                                                                                  : 21;
  static_assert(std::numeric_limits<Real>::digits <= 113);

  Real log_ratio_less_one;  ///< −log1p(−w)/w − 1
  Real curvature;           ///< (w/(1−w) + log1p(−w))/w², 1/2 at w = 0

  explicit SmallSeries(Real w) {
    constexpr std::array<Real, kTerms> kCoefficients = [] {
      std::array<Real, kTerms> coefficients{};
      for (std::size_t k = 0; k < kTerms; ++k) coefficients[k] = Real(1) / Real(2 * k + 3);
      return coefficients;
    }();
    const Real s = w / (2 - w);
    const Real square = s * s;
    Real sum = kCoefficients[kTerms - 1];
    for (std::size_t k = kTerms - 1; k-- > 0;) sum = sum * square + kCoefficients[k];
    log_ratio_less_one = s + (1 + s) * square * sum;
    curvature = (1 + s) * (1 + s) / 2 * (1 / (1 - s) - s * sum);
  }
};

/// What the branch law is at a displacement short of slip.
template <typename Real>
struct Shares {
  Real log_remaining;  ///< log u
  Real remaining;      ///< u
  Real force;          ///< φ = 1 − u
  Real slope;          ///< φ' = u^α = u/z
};

/// Any α >= 0. Two transcendentals a value, one near y = 0 and α = 1.
template <typename Real>
struct GeneralShape {
  Real shape_exponent;

  /// z is rounded once: near slip, where it cancels, 1 − y or 1 − α is exact.
  [[nodiscard]] Reduced<Real> Reduce(Real y) const {
    const Real w = (1 - shape_exponent) * y;
    const Real z = w < kNearSlip ? 1 - w
                   : y <= 2      ? std::fma(shape_exponent, y, 1 - y)
                                 : std::fma(shape_exponent - 1, y, Real(1));
    return {y, w, z};
  }

  /// For z > 0. Which form serves depends on w, for none to cancel: near slip the power of z, where
  /// φ' = u^α keeps the digits that u/z would lose for α → 0; else log u, and of u and φ the
  /// smaller from it.
  [[nodiscard]] Shares<Real> At(const Reduced<Real>& at) const {
    constexpr Real kHalf = Real(-0.6875);  // log ½, short enough to be exact
    const Real beta = 1 - shape_exponent;
    if (at.w >= kNearSlip) {
      const Real log_remaining = std::log(at.z) / beta;
      const Real slope = std::exp(shape_exponent * log_remaining);
      const Real remaining = slope * at.z;
      return {log_remaining, remaining, 1 - remaining, slope};
    }
    // The series makes nothing special of α = 1 and y = 0.
    const Real log_remaining = std::abs(at.w) < SmallSeries<Real>::kSmall
                                   ? -at.y - at.y * SmallSeries<Real>(at.w).log_ratio_less_one
                                   : std::log1p(-at.w) / beta;
    if (log_remaining < kHalf) {
      const Real remaining = std::exp(log_remaining);
      return {log_remaining, remaining, 1 - remaining, remaining / at.z};
    }
    const Real force = -std::expm1(log_remaining);
    return {log_remaining, 1 - force, force, (1 - force) / at.z};
  }

  /// u, the share of the slip force still to be mobilised.
  [[nodiscard]] Real Remaining(const Reduced<Real>& at) const {
    return at.z > 0 ? At(at).remaining : Real(0);
  }

  /// φ
  [[nodiscard]] Real Force(const Reduced<Real>& at) const {
    return at.z > 0 ? At(at).force : Real(1);
  }
  [[nodiscard]] Real Force(Real y) const { return Force(Reduce(y)); }

  /// φ'; 0 at and beyond gross slip.
  [[nodiscard]] Real Slope(const Reduced<Real>& at) const {
    return at.z > 0 ? At(at).slope : Real(0);
  }

 private:
  static constexpr Real kNearSlip = Real(0.5);  // of w
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

/// ∂φ/∂α = −u·(y/z + log u)/β = −u·y²·(w/(1−w) + log1p(−w))/w²: the second form, by its series,
/// where the first cancels.
template <typename Real>
ForceAndDerivatives<Real> Differentiate(const Reduced<Real>& at, Real shape_exponent) {
  if (at.z <= 0) return {.force = 1};
  const Shares<Real> share = GeneralShape<Real>{shape_exponent}.At(at);
  const Real elastic = at.y * share.slope;
  const Real shape_derivative =
      std::abs(at.w) < SmallSeries<Real>::kSmall
          ? share.remaining * at.y * at.y * SmallSeries<Real>(at.w).curvature
          : (elastic + share.remaining * share.log_remaining) / (1 - shape_exponent);
  return {share.force, share.slope, elastic, -shape_derivative};
}
template <typename Real>
ForceAndDerivatives<Real> Differentiate(Real y, Real shape_exponent) {
  return Differentiate(GeneralShape<Real>{shape_exponent}.Reduce(y), shape_exponent);
}

}  // namespace mindahl::backbone
