#include "mindahl/models/steady_loop.h"

#include <cmath>
#include <limits>

#include "core/refuse.h"
#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "models/scaled_branches.h"

namespace mindahl::models {
namespace {

using ExtendedShape = backbone::GeneralShape<long double>;

/// @throws InvalidArgument naming what is wrong of either
void Require(const BranchLaw& law, double amplitude) {
  Validate(law);
  if (!(amplitude >= 0 && amplitude <= kLargestPathDisplacement)) {
    ThrowInvalid("amplitude [m]", amplitude, "must be >= 0 and <= 1e100 m");
  }
}

/// Returns the energy by its series.
long double LoopEnergySeries(long double y, long double shape_exponent) {
  constexpr int kTerms = 80;
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
long double NearlyElasticSlip(const backbone::SplitDisplacement& y, long double shape_exponent) {
  if (y.high >= 1) {
    return (y.high - 1) + y.low +
           ExtendedShape{shape_exponent}.Remaining(backbone::Reduce(y, shape_exponent));
  }
  const long double stuck = (1 - y.high) - y.low;
  const long double log_ratio =
      (shape_exponent * std::log(stuck) + std::log1p(shape_exponent * y.high / stuck)) /
      (1 - shape_exponent);
  return stuck * std::expm1(log_ratio);
}

/// Returns ∫φ beyond the series, α middling.
long double MiddlingWork(const backbone::SplitDisplacement& y, long double shape_exponent) {
  const long double exponent = 2 - shape_exponent;
  const auto reduced = backbone::Reduce(y, shape_exponent);
  if (reduced.z <= 0) return y.high - 1 / exponent;
  // (1 − u^{2−α})/(2−α) = −expm1(v)/v · log u with v = (2−α)·log u, which is smooth through α = 2.
  const long double log_remaining = ExtendedShape{shape_exponent}.At(reduced).log_remaining;
  const long double stored =
      exponent == 0 ? -log_remaining : -std::expm1(exponent * log_remaining) / exponent;
  return y.high - stored;
}

/// Returns the energy lost in a closed Masing loop of amplitude y over Tc²/σ, 8∫₀^y φ ds − 4yφ(y).
/// → (2/3)·α·y³ as y → 0, where both terms cancel: there by the series
///   φ = −Σ (−y)ᵏ pₖ,  pₖ = Π_{j<k}(1 − jβ)/k!,   loop = Σ_{k>=2} (−1)ᵏ pₖ (4 − 8/(k+1)) y^{k+1}.
/// They cancel as well for α < 1/2, up to slip, and for α > 4: there as 4[2(y − φ) − αyφ]/(2−α).
/// In long double, whose spare digits are what the closed forms lose by cancellation; relative
/// error below 2⁻⁵⁴ where it has 64 bits.
long double MasingLoopEnergy(const backbone::SplitDisplacement& y, long double shape_exponent) {
  // The series converges as the larger of |βy|ᵏ and yᵏ/k!; to here it needs fewer than 80 terms.
  constexpr long double kSeriesLimit = 0.5L;
  // Between these α the integral follows from u^{2−α}, outside them from the slip y − φ, by a
  // formula that is singular at α = 2 only and cancels less: as 1 against α below, 1 against αy
  // above.
  constexpr long double kNearlyElastic = 0.5L;
  constexpr long double kSoon = 4.0L;
  if (y.high <= kSeriesLimit && std::abs((1 - shape_exponent) * y.high) <= kSeriesLimit) {
    return LoopEnergySeries(y.high, shape_exponent);
  }
  const long double force =
      ExtendedShape{shape_exponent}.Force(backbone::Reduce(y, shape_exponent));
  if (shape_exponent >= kNearlyElastic && shape_exponent <= kSoon) {
    return 8 * MiddlingWork(y, shape_exponent) - 4 * y.high * force;
  }
  const long double slip =
      shape_exponent < 1 ? NearlyElasticSlip(y, shape_exponent) : y.high - force;
  return 4 * (2 * slip - shape_exponent * y.high * force) / (2 - shape_exponent);
}

/// Makes a law in long double: a power of α multiplies the error of its logarithm by α.
BranchLaw Made(long double stiffness, double shape_exponent, long double slip_force) {
  const BranchLaw law = {.tangential_stiffness = static_cast<double>(stiffness),
                         .shape_exponent = shape_exponent,
                         .slip_force = static_cast<double>(slip_force)};
  Validate(law);
  return law;
}

}  // namespace

double SteadyPeakForce(const FrictionModel& model, const BranchLaw& law, double amplitude) {
  Require(law, amplitude);
  return law.slip_force * BranchScaling(model, Normalized(law)).Peak(amplitude).force;
}

double SteadyLoopEnergy(const FrictionModel& model, const BranchLaw& law, double amplitude) {
  Require(law, amplitude);
  const auto y = backbone::Normalize(law.tangential_stiffness, amplitude, law.slip_force);
  const long double unit =
      static_cast<long double>(law.slip_force) * law.slip_force / law.tangential_stiffness;
  const double peak = BranchScaling(model, Normalized(law)).Peak(amplitude).force;
  const BranchScale scale = model.scale(-peak, /*virgin=*/false);
  // A branch runs from −t* to t* = −t* + h·φ(2ky), so W = 2[∫ branch − 2y·t*] is a Masing loop's
  // energy in other units, (h/4k)·[8∫₀^{2ky} φ − 4·(2ky)·φ(2ky)]: one form, free of cancellation.
  const long double height = static_cast<long double>(scale.span) * scale.remaining;
  const long double rate =
      std::pow(static_cast<long double>(scale.remaining), law.shape_exponent - 1.0L) / scale.span;
  const long double stretch = 2 * rate;  // 1 for a Masing law
  return Representable(
      "energy per cycle [J]",
      unit * height / (2 * stretch) *
          MasingLoopEnergy({stretch * y.high, stretch * y.low}, law.shape_exponent));
}

double ContactAmplitude(const FrictionModel& model, const BranchLaw& law, const SeriesSpring& rig,
                        double amplitude) {
  Require(law, amplitude);
  Validate(rig);
  if (std::isinf(rig.stiffness)) return amplitude;
  const double rate = law.tangential_stiffness / law.slip_force;
  const NormalizedLaw in_series{rate, law.shape_exponent, law.slip_force / rig.stiffness};
  return BranchScaling(model, in_series).ContactAmplitude(rate * amplitude) / rate;
}

BranchLaw DahlEquivalent(const BranchLaw& masing, double amplitude) {
  Require(masing, amplitude);
  // 1 − T*/(2Tc) = (1 + u)/2 has the digits that T* → Tc would lose.
  const long double remaining = BackboneRemaining(masing, amplitude);
  return Made(masing.tangential_stiffness * std::pow((1 + remaining) / 2, masing.shape_exponent),
              masing.shape_exponent, masing.slip_force * (1 + remaining));
}

BranchLaw MasingEquivalent(const BranchLaw& dahl, double amplitude) {
  Require(dahl, amplitude);
  const long double peak = SteadyPeakForce(*FindFrictionModel("dahl"), dahl, amplitude);
  return Made(dahl.tangential_stiffness * std::pow(1 + peak / dahl.slip_force, dahl.shape_exponent),
              dahl.shape_exponent, (dahl.slip_force + peak) / 2);
}

}  // namespace mindahl::models
