#pragma once

#include <boost/math/tools/toms748_solve.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstdint>
#include <limits>

/// The branch law by its plain closed forms, at so many digits that no cancellation matters. Shares
/// nothing with the library: it is what the library is checked against.
namespace reference {

/// Digits for α >= 1e-30 and y >= 1e-30, where the loop energy, α·y³, cancels against y².
using Digits150 = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<150>>;
/// Digits for every double: α = 1e-300 costs the loop energy 300.
using Digits500 = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<500>>;

/// In units of Tc and Tc/σ.
template <typename Real>
struct NormalizedLaw {
  Real force, remaining, slope, work, per_log_stiffness, per_shape, per_log_slip_force, loop_energy;
};

/// b = 1−α, z = max(1−by, 0), u = z^{1/b} (e^{−y} for α = 1), f = 1−u, slope u^α;
/// work = y − (1−u^{2−α})/(2−α) (y − ln(1+y) for α = 2); loop = 8·work − 4yf;
/// per_shape = ∂f/∂α = −u(y/z + ln u)/b (−uy²/2 for α = 1). Slope and derivatives at z = 0 are
/// those of gross slip, 0.
template <typename Real>
NormalizedLaw<Real> EvaluateNormalized(const Real& alpha, const Real& y) {
  const Real beta = 1 - alpha;
  Real z = 1 - beta * y;
  if (z < 0) z = 0;
  NormalizedLaw<Real> law;
  if (z == 0) {
    law.remaining = law.slope = law.per_shape = 0;
  } else {
    const Real log_remaining = beta == 0 ? Real(-y) : Real(log(z) / beta);
    law.remaining = exp(log_remaining);
    law.slope = law.remaining / z;
    law.per_shape = beta == 0 ? Real(-law.remaining * y * y / 2)
                              : Real(-law.remaining * (y / z + log_remaining) / beta);
  }
  law.force = 1 - law.remaining;
  const Real exponent_left = 2 - alpha;
  // u^{2−α} = u·z
  law.work =
      exponent_left == 0 ? Real(y - log(1 + y)) : Real(y - (1 - law.remaining * z) / exponent_left);
  law.per_log_stiffness = y * law.slope;
  law.per_log_slip_force = law.force - law.per_log_stiffness;
  law.loop_energy = 8 * law.work - 4 * y * law.force;
  if (alpha == 0 && y <= 1) law.loop_energy = 0;  // not what rounding leaves of it
  return law;
}

/// The steady loop of Dahl's own law between ±y: v = 1 − sT/Tc falls from 1 + t* to 1 − t* (or to
/// 0) over 2y with dv/dy = −v^α.
template <typename Real>
struct DahlLoop {
  Real peak, energy;
};

template <typename Real>
DahlLoop<Real> EvaluateDahlLoop(const Real& alpha, const Real& y) {
  const Real beta = 1 - alpha;
  const auto power = [](const Real& base, const Real& exponent) {
    return base <= 0 ? Real(0) : Real(exp(exponent * log(base)));
  };
  // Amplitude of the loop with peak t, less y.
  const auto excess = [&](const Real& t) {
    const Real way = beta == 0 ? Real(log((1 + t) / (1 - t)))
                               : Real((power(1 + t, beta) - power(1 - t, beta)) / beta);
    return Real(way / 2 - y);
  };
  DahlLoop<Real> loop;
  const Real nearly_one = 1 - Real("1e-60");
  if (beta > 0 && excess(Real(1)) <= 0) {
    loop.peak = 1;
  } else if (excess(nearly_one) <= 0) {
    loop.peak = nearly_one;
  } else {
    std::uintmax_t iterations = 1000;
    const auto close = [](const Real& low, const Real& high) {
      constexpr int kDigits = std::numeric_limits<Real>::digits10 - 10;
      return abs(Real(high - low)) <= pow(Real(10), -kDigits) * high;
    };
    const auto bracket = boost::math::tools::toms748_solve(
        excess, Real((y < 1 ? y : Real(1)) / (200 * (1 + alpha))), nearly_one, close, iterations);
    loop.peak = (bracket.first + bracket.second) / 2;
  }
  const Real exponent = 2 - alpha;
  const Real above = 1 + loop.peak;
  const Real below = 1 - loop.peak;
  const Real stuck = exponent == 0
                         ? Real(log(above / below))
                         : Real((power(above, exponent) - power(below, exponent)) / exponent);
  loop.energy = 2 * (2 * y - stuck);
  if (alpha == 0 && y <= 1) loop.energy = 0;
  return loop;
}

}  // namespace reference
