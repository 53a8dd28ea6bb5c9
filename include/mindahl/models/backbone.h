#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace mindahl::models::backbone {

/// The branch law in normalised form, which every model here follows (docs/theory.md §4).
///   φ(y) = 1 − u,   u = e_α(−y) = [1 − (1−α)·y]₊^{1/(1−α)},   e₁(−y) = exp(−y)
/// y = σx/Tc >= 0 is the displacement from the branch's origin over the elastic limit Tc/σ and φ
/// the force over Tc. With β = 1 − α, w = β·y, z = 1 − w: u = z^{1/β} and φ' = u^α = u/z. Inline
/// and free of checks: they are the inside of every kernel. Callers validate (branch_law.h,
/// loading_path.h), so that neither y nor (1−α)y exceeds the largest double. Nothing here raises
/// the invalid, overflow or division-by-zero flag of floating-point arithmetic.
///
/// Errors (docs/accuracy.md), in ε of Real: φ relative 4 ε; u, φ' and the derivatives 4 ε of 1.

/// Largest κ of a spring in series: Y − κ is still beyond slip at the largest Y.
inline constexpr double kLargestSeriesCompliance = 1e100;

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
  static constexpr std::size_t kTerms = std::numeric_limits<Real>::digits <= 53   ? 9
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

/// Holds the values of the branch law at a displacement short of slip.
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

  /// Returns u, the fraction of the slip force still to be mobilised.
  [[nodiscard]] Real Remaining(const Reduced<Real>& at) const {
    return at.z > 0 ? At(at).remaining : Real(0);
  }

  /// Returns φ.
  [[nodiscard]] Real Force(const Reduced<Real>& at) const {
    return at.z > 0 ? At(at).force : Real(1);
  }
  [[nodiscard]] Real Force(Real y) const { return Force(Reduce(y)); }

  /// Returns φ'; 0 at and beyond gross slip.
  [[nodiscard]] Real Slope(Real y) const {
    const Reduced<Real> at = Reduce(y);
    return at.z > 0 ? At(at).slope : Real(0);
  }

 private:
  static constexpr Real kNearSlip = Real(0.5);  // of w
};

/// α = 1/3, Mindlin: u = z·√z with z = 1 − 2y/3. A square root and a division a value.
struct MindlinShape {
  /// Returns 1 − z√z = (1 − z³)/(1 + z√z) = w(1 + z + z²)/(1 + z√z): no cancellation as y → 0.
  [[nodiscard]] double Force(double y) const {
    const double w = std::min(2.0 / 3 * y, 1.0);
    const double z = 1 - w;
    return w * (1 + z + z * z) / (1 + z * std::sqrt(z));
  }

  /// Returns √z.
  [[nodiscard]] double Slope(double y) const {
    return std::sqrt(std::max(GeneralShape<double>{1.0 / 3}.Reduce(y).z, 0.0));
  }
};

/// α = 0, Jenkins: elastic, then perfectly plastic.
struct JenkinsShape {
  [[nodiscard]] double Force(double y) const { return std::min(y, 1.0); }
  [[nodiscard]] double Slope(double y) const { return y < 1 ? 1.0 : 0.0; }
};

/// Calls `visitor` with the cheapest shape that is exact for α: chosen once, outside the kernels.
template <typename Visitor>
decltype(auto) WithShape(double shape_exponent, Visitor&& visitor) {
  if (shape_exponent == 0.0) return visitor(JenkinsShape{});
  if (shape_exponent == 1.0 / 3) return visitor(MindlinShape{});
  return visitor(GeneralShape<double>{shape_exponent});
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
ForceAndDerivatives<Real> Differentiate(Real y, Real shape_exponent) {
  const GeneralShape<Real> shape{shape_exponent};
  const Reduced<Real> at = shape.Reduce(y);
  if (at.z <= 0) return {.force = 1};
  const Shares<Real> share = shape.At(at);
  const Real elastic = at.y * share.slope;
  const Real shape_derivative =
      std::abs(at.w) < SmallSeries<Real>::kSmall
          ? share.remaining * at.y * at.y * SmallSeries<Real>(at.w).curvature
          : (elastic + share.remaining * share.log_remaining) / (1 - shape_exponent);
  return {share.force, share.slope, elastic, -shape_derivative};
}

/// Φ (below) with its derivatives, which are the contact's at y over 1 + κφ'.
struct SeriesDerivatives {
  ForceAndDerivatives<double> contact;  // φ(y) = Φ
  double share = 1;                     // dy/dY = 1/(1+κφ')
  double log_compliance = 0;            // κ·∂Φ/∂κ = −κφφ'/(1+κφ')
};

/// The branch law in series with a spring, as a function of the displacement Y of both, over Tc/σ:
///   Φ(Y) = φ(y),   y + κ·φ(y) = Y,   κ = σ/k the branch's stiffness over the spring's
/// (docs/theory.md §5). In ℓ = −log u both terms of the left side are decays of one kind, and no z
/// or u cancels:
///   y = D(β,ℓ),  φ = D(1,ℓ),  D(c,ℓ) = (1 − e^{−cℓ})/c
/// Where κφ' >= 1 the spring is more compliant than the contact, elsewhere less: Y is there nearly
/// linear in φ and in y, with a slope that varies by less than twofold. Tangents at the ends of
/// either part start an iteration of third order, whose steps take the sum of the two decays for
/// one decay: exact for κ → 0, for κ → ∞ and for α = 0.
/// For 0 <= κ <= kLargestSeriesCompliance and Y >= 0; Φ has a relative error below 4 ε. At most 3
/// iterations, found over 3e7 points, each of two or three transcendentals; none for κ = 0 or α =
/// 0.
class InSeries {
 public:
  InSeries(double shape_exponent, double compliance)
      : shape_exponent_(shape_exponent), beta_(1 - shape_exponent), compliance_(compliance) {
    if (compliance <= 1) return;  // φ' <= 1: the spring is the stiffer everywhere
    // ℓ where κφ' = κ·e^{−αℓ} = 1; kFarthest where u underflows before.
    constexpr double kFarthest = -2.0 * std::numeric_limits<double>::min_exponent;
    const double log_compliance = std::log(compliance);
    const double balance =
        log_compliance < kFarthest * shape_exponent ? log_compliance / shape_exponent : kFarthest;
    balance_force_ = ForceAt(balance);
    balance_displacement_ = DecayOf(beta_, balance).sum;
    balance_total_ = balance_displacement_ + compliance * balance_force_;
  }

  /// Beyond slip the contact's displacement is Y − κ.
  [[nodiscard]] bool Slips(double total) const {
    return beta_ > 0 && beta_ * total >= 1 + beta_ * compliance_;
  }

  /// Returns Φ.
  [[nodiscard]] double Force(double total) const {
    if (shape_exponent_ == 0) return std::min(total / (1 + compliance_), 1.0);
    if (compliance_ == 0) return GeneralShape<double>{shape_exponent_}.Force(total);
    return Slips(total) ? 1.0 : ForceAt(LogShare(total));
  }

  /// Returns dΦ/dY = φ'/(1+κφ').
  [[nodiscard]] double Slope(double total) const {
    if (Slips(total)) return 0;
    const double slope = GeneralShape<double>{shape_exponent_}.Slope(ContactDisplacement(total));
    return slope / (1 + compliance_ * slope);
  }

  [[nodiscard]] SeriesDerivatives Differentiate(double total) const {
    if (Slips(total)) return {.contact = {.force = 1}};
    const auto contact = backbone::Differentiate(ContactDisplacement(total), shape_exponent_);
    const double yielding = compliance_ * contact.slope;
    return {contact, 1 / (1 + yielding), -contact.force * (yielding / (1 + yielding))};
  }

 private:
  struct Decay {
    double sum;   // D(c,ℓ)
    double rest;  // e^{−cℓ}
  };

  /// |cℓ| below which D = ℓ to rounding; its expm1 might underflow.
  static constexpr double kUndecayed = std::numeric_limits<double>::epsilon() / 2;

  /// Neither from a difference that cancels.
  static Decay DecayOf(double rate, double log_share) {
    const double x = rate * log_share;
    if (x > 0.5) {
      const double rest = std::exp(-x);
      return {(1 - rest) / rate, rest};
    }
    if (std::abs(x) < kUndecayed) return {log_share, 1 - x};
    const double change = -std::expm1(-x);
    return {change / rate, 1 - change};
  }
  /// Returns y at Y short of slip.
  [[nodiscard]] double ContactDisplacement(double total) const {
    if (shape_exponent_ == 0) return total / (1 + compliance_);
    return compliance_ == 0 ? total : DecayOf(beta_, LogShare(total)).sum;
  }
  [[nodiscard]] static double ForceAt(double log_share) { return -std::expm1(-log_share); }

  /// Returns ℓ from a fraction of what is left to go, which rounding may have used up.
  static double FromShare(double share) {
    return -std::log1p(-std::min(share, 1 - std::numeric_limits<double>::epsilon() / 2));
  }

  [[nodiscard]] double Start(double total) const {
    const double beyond = total - balance_total_;
    if (beyond < 0) {
      return FromShare(
          std::min(total / (1 + compliance_), balance_force_ + beyond / (2 * compliance_)));
    }
    const double y = std::max(total - compliance_,
                              balance_displacement_ + beyond / (1 + std::min(compliance_, 1.0)));
    return std::abs(beta_ * y) < kUndecayed ? y : FromShare(beta_ * y) / beta_;
  }

  /// −log(1 − x)/x, for small x by atanh: 1e-10 of a step serves all but the last, which is small.
  static double LogRatio(double x) {
    if (std::abs(x) > 0.0625) return -std::log1p(-x) / x;
    const double half = 1 / (2 - x);
    const double square = x * half * (x * half);
    return 2 * half * (1 + square * (1.0 / 3 + square / 5));
  }

  /// Returns ℓ at Y short of slip.
  [[nodiscard]] double LogShare(double total) const {
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
    constexpr double kRounding = 16 * kEpsilon;  // of Y: what the residual is known to
    constexpr double kLongestStep = 0.9999;      // of what the one decay has left
    constexpr double kSettled =
        1.0 / (std::uint64_t{1} << (std::numeric_limits<double>::digits + 1) / 3);  // ∛(ε/4)
    constexpr int kIterations = 8;
    if (total == 0) return 0;
    double log_share = Start(total);
    for (int i = 0; i < kIterations; ++i) {
      const Decay contact = DecayOf(beta_, log_share);
      const Decay force = DecayOf(1.0, log_share);
      const double residual = (total - contact.sum) - compliance_ * force.sum;
      const double slope = contact.rest + compliance_ * force.rest;
      const double rate = 1 - shape_exponent_ * (contact.rest / slope);  // β and 1 by their parts
      const double newton = residual / slope;
      const double share = std::min(rate * newton, kLongestStep);
      const double step = newton * LogRatio(share);
      log_share = std::max(log_share + step, log_share / 2);
      // The next error is below the cube of this step's.
      if (std::abs(step) <= kSettled * log_share || std::abs(residual) <= kRounding * total) break;
    }
    return log_share;
  }

  double shape_exponent_;
  double beta_;
  double compliance_;
  double balance_force_ = 0;         // φ where κφ' = 1
  double balance_displacement_ = 0;  // y there
  double balance_total_ = 0;         // Y there
};

/// y as the unevaluated sum of two numbers, the second below an ulp of the first: near slip
/// z = 1 − βy cancels, and the rounding of y alone would decide its digits.
struct SplitDisplacement {
  long double high = 0.0L;
  long double low = 0.0L;
};

/// Returns y = stiffness·|x|/slip_force of three doubles, to twice the digits of long double.
inline SplitDisplacement Normalize(double stiffness, double x, double slip_force) {
  const long double reach = std::abs(x);
  const long double product = stiffness * reach;
  const long double product_low = std::fma(stiffness, reach, -product);
  const long double quotient = product / slip_force;
  return {quotient, (std::fma(-quotient, slip_force, product) + product_low) / slip_force};
}

/// Reduces y with z to full relative precision.
inline Reduced<long double> Reduce(const SplitDisplacement& y, long double shape_exponent) {
  Reduced<long double> reduced = GeneralShape<long double>{shape_exponent}.Reduce(y.high);
  reduced.z -= (1 - shape_exponent) * y.low;
  return reduced;
}

}  // namespace mindahl::models::backbone
