#include "mindahl/models/backbone_integrals.h"

#include <cmath>
#include <limits>

#include "mindahl/models/backbone.h"

namespace mindahl::backbone {
namespace {

/// Both series converge as the larger of |βy|ᵏ and yᵏ/k!; to here they need fewer than kTerms
/// terms.
constexpr long double kSeriesLimit = 0.5L;
constexpr int kTerms = 80;

/// Below this α the two terms of the loop energy cancel by more than long double has to spare.
constexpr long double kNearlyElastic = 1.0L / 128;

bool SeriesConverges(long double y, long double shape_exponent) {
  return y <= kSeriesLimit && std::abs((1 - shape_exponent) * y) <= kSeriesLimit;
}

/// Σ_{k>=first} (−1)ᵏ·pₖ·weight(k)·y^{k+1}
template <typename Weight>
long double BackboneSeries(long double y, long double shape_exponent, int first, Weight weight) {
  const long double beta = 1 - shape_exponent;
  long double term = y;  // (−1)ᵏ pₖ y^{k+1}
  long double sum = 0;
  for (int k = 1; k < kTerms; ++k) {
    // p₂ = α/2 exactly, without the rounding of 1 − β.
    const long double factor = k == 2 ? shape_exponent : 1 - (k - 1) * beta;
    term *= -y * factor / k;
    if (k >= first) sum += term * weight(k);
    if (std::abs(term) <= std::numeric_limits<long double>::epsilon() * std::abs(sum)) break;
  }
  return sum;
}

/// y − φ(y), the slip over the elastic limit, to full precision for α → 0: with 1 − y below the
/// limit as a factor, u = (1 − y)·exp([α·log(1−y) + log(1 + αy/(1−y))]/β).
long double Slip(long double y, long double shape_exponent) {
  if (y >= 1) return (y - 1) + GeneralShape<long double>{shape_exponent}.Remaining(y);
  const long double stuck = 1 - y;
  const long double log_ratio =
      (shape_exponent * std::log(stuck) + std::log1p(shape_exponent * y / stuck)) /
      (1 - shape_exponent);
  return stuck * std::expm1(log_ratio);
}

}  // namespace

long double Work(long double y, long double shape_exponent) {
  if (SeriesConverges(y, shape_exponent)) {
    return BackboneSeries(y, shape_exponent, 1, [](int k) { return -1.0L / (k + 1); });
  }
  // (1 − u^{2−α})/(2−α) = −expm1(v)/v · log u with v = (2−α)·log u, which is smooth through α = 2.
  const long double log_remaining = GeneralShape<long double>{shape_exponent}.LogRemaining(y);
  const long double exponent = 2 - shape_exponent;
  const long double stored =
      exponent == 0 ? -log_remaining : -std::expm1(exponent * log_remaining) / exponent;
  return y - stored;
}

long double MasingLoopEnergy(long double y, long double shape_exponent) {
  if (SeriesConverges(y, shape_exponent)) {
    return BackboneSeries(y, shape_exponent, 2, [](int k) { return 4 - 8.0L / (k + 1); });
  }
  const long double force = GeneralShape<long double>{shape_exponent}.Force(y);
  if (shape_exponent < kNearlyElastic) {
    return 4 * (2 * Slip(y, shape_exponent) - shape_exponent * y * force) / (2 - shape_exponent);
  }
  return 8 * Work(y, shape_exponent) - 4 * y * force;
}

}  // namespace mindahl::backbone
