#include "mindahl/models/backbone.h"

namespace mindahl::models::backbone {
namespace {

using Shape = GeneralShape<long double>;

/// The series converges as the larger of |βy|ᵏ and yᵏ/k!; to here it needs fewer than kTerms terms.
constexpr long double kSeriesLimit = 0.5L;
constexpr int kTerms = 80;

/// Between these α the integral follows from u^{2−α}, outside them from the slip y − φ, by a
/// formula that is singular at α = 2 only and cancels less: as 1 against α below, 1 against αy
/// above.
constexpr long double kNearlyElastic = 0.5L;
constexpr long double kSoon = 4.0L;

/// Returns the energy by its series.
long double LoopEnergySeries(long double y, long double shape_exponent) {
  const long double beta = 1 - shape_exponent;
  long double term = y;  // (−1)ᵏ pₖ y^{k+1}
  long double sum = 0;
  for (int k = 1; k < kTerms; ++k) {
    // p₂ = α/2 exactly, without the rounding of 1 − β.
    const long double factor = k == 2 ? shape_exponent : 1 - (k - 1) * beta;
    term *= -y * factor / k;
    if (k >= 2) sum += term * (4 - 8.0L / (k + 1));
    if (std::abs(term) <= std::numeric_limits<long double>::epsilon() * std::abs(sum)) break;
  }
  return sum;
}

/// y − φ(y), the slip over the elastic limit, to full precision for α → 0: with 1 − y below the
/// limit as a factor, u = (1 − y)·exp([α·log(1−y) + log(1 + αy/(1−y))]/β).
long double NearlyElasticSlip(const SplitDisplacement& y, long double shape_exponent) {
  if (y.high >= 1) {
    return (y.high - 1) + y.low + Shape{shape_exponent}.Remaining(Reduce(y, shape_exponent));
  }
  const long double stuck = (1 - y.high) - y.low;
  const long double log_ratio =
      (shape_exponent * std::log(stuck) + std::log1p(shape_exponent * y.high / stuck)) /
      (1 - shape_exponent);
  return stuck * std::expm1(log_ratio);
}

/// Returns ∫φ beyond the series, α middling.
long double MiddlingWork(const SplitDisplacement& y, long double shape_exponent) {
  const long double exponent = 2 - shape_exponent;
  const Reduced<long double> reduced = Reduce(y, shape_exponent);
  if (reduced.z <= 0) return y.high - 1 / exponent;
  // (1 − u^{2−α})/(2−α) = −expm1(v)/v · log u with v = (2−α)·log u, which is smooth through α = 2.
  const long double log_remaining = Shape{shape_exponent}.At(reduced).log_remaining;
  const long double stored =
      exponent == 0 ? -log_remaining : -std::expm1(exponent * log_remaining) / exponent;
  return y.high - stored;
}

}  // namespace

SplitDisplacement Normalize(double stiffness, double x, double slip_force) {
  const long double reach = std::abs(x);
  const long double product = stiffness * reach;
  const long double product_low = std::fma(stiffness, reach, -product);
  const long double quotient = product / slip_force;
  return {quotient, (std::fma(-quotient, slip_force, product) + product_low) / slip_force};
}

Reduced<long double> Reduce(const SplitDisplacement& y, long double shape_exponent) {
  Reduced<long double> reduced = Shape{shape_exponent}.Reduce(y.high);
  reduced.z -= (1 - shape_exponent) * y.low;
  return reduced;
}

long double MasingLoopEnergy(const SplitDisplacement& y, long double shape_exponent) {
  if (y.high <= kSeriesLimit && std::abs((1 - shape_exponent) * y.high) <= kSeriesLimit) {
    return LoopEnergySeries(y.high, shape_exponent);
  }
  const long double force = Shape{shape_exponent}.Force(Reduce(y, shape_exponent));
  if (shape_exponent >= kNearlyElastic && shape_exponent <= kSoon) {
    return 8 * MiddlingWork(y, shape_exponent) - 4 * y.high * force;
  }
  const long double slip =
      shape_exponent < 1 ? NearlyElasticSlip(y, shape_exponent) : y.high - force;
  return 4 * (2 * slip - shape_exponent * y.high * force) / (2 - shape_exponent);
}

}  // namespace mindahl::models::backbone
