#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/variable_load.h"

namespace mindahl::models {

/// A number with its derivatives in some directions, for arithmetic that takes them along.
template <std::size_t kDirections>
struct Tangent {
  double value = 0.0;
  std::array<double, kDirections> slope{};

  Tangent() = default;
  Tangent(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): a number

  /// Returns the number itself, which varies as one in a direction.
  [[nodiscard]] static Tangent Along(double at, std::size_t direction, double by = 1.0) {
    Tangent result(at);
    result.slope[direction] = by;
    return result;
  }

  /// Returns f(x), from f and f' at x.
  [[nodiscard]] Tangent Through(double function, double derivative) const {
    Tangent result(function);
    for (std::size_t k = 0; k < kDirections; ++k) result.slope[k] = derivative * slope[k];
    return result;
  }

  friend Tangent operator+(Tangent a, const Tangent& b) {
    a.value += b.value;
    for (std::size_t k = 0; k < kDirections; ++k) a.slope[k] += b.slope[k];
    return a;
  }
  friend Tangent operator-(Tangent a, const Tangent& b) {
    a.value -= b.value;
    for (std::size_t k = 0; k < kDirections; ++k) a.slope[k] -= b.slope[k];
    return a;
  }
  friend Tangent operator*(const Tangent& a, const Tangent& b) {
    Tangent result(a.value * b.value);
    for (std::size_t k = 0; k < kDirections; ++k) {
      result.slope[k] = a.value * b.slope[k] + b.value * a.slope[k];
    }
    return result;
  }
  friend Tangent operator*(double a, Tangent b) {
    b.value *= a;
    for (double& each : b.slope) each *= a;
    return b;
  }
  friend Tangent operator/(const Tangent& a, const Tangent& b) {
    Tangent result(a.value / b.value);
    for (std::size_t k = 0; k < kDirections; ++k) {
      result.slope[k] = (a.slope[k] - result.value * b.slope[k]) / b.value;
    }
    return result;
  }
};

/// Returns the number without its derivatives, which alone decides between cases.
inline double ValueOf(double x) { return x; }
template <std::size_t kDirections>
double ValueOf(const Tangent<kDirections>& x) {
  return x.value;
}

/// Returns x within ±limit; beyond it the limit, with the limit's derivatives.
template <typename Real>
Real Within(const Real& x, const Real& limit) {
  if (ValueOf(x) > ValueOf(limit)) return limit;
  if (ValueOf(x) < -ValueOf(limit)) return -1.0 * limit;
  return x;
}

/// A step of a contact under a varying load, straight in (δ, δc).
template <typename Real>
struct LoadStep {
  LoadRim<Real> from;
  LoadRim<Real> to;
  double from_displacement = 0.0;
  double displacement = 0.0;
  Real force{};  // before the step
};

/// The load rises faster than anything can slip: elements come into contact at the rim, each
/// resting where δ is when it does. On the line of those before it makes no zone of its own.
template <typename Real>
Real WidenLoadZones(const LoadStep<Real>& step, const Real& slope,
                    std::vector<LoadZone<Real>>& zones) {
  const Real intercept = Real(step.from_displacement) - slope * step.from.slip_displacement;
  const bool goes_on = !zones.empty() && ValueOf(zones.back().slope) == ValueOf(slope) &&
                       ValueOf(zones.back().intercept) == ValueOf(intercept);
  if (!goes_on) {
    zones.push_back(
        {step.from.slip_displacement, slope, intercept, step.force, step.from.slip_force});
  }
  return step.force + slope * (step.to.slip_force - step.from.slip_force);
}

/// An annulus slips to the rest positions δ − s·(δc − h), s the sign of `stretch`, which is δ − r
/// at the rim. As |r'| <= 1, what slips is outside of what sticks.
/// @param share  (width, δc) of an annulus to the fraction of the slip force that it carries
template <typename Real, typename Share>
Real SlipLoadZones(const LoadStep<Real>& step, double stretch, const Share& share,
                   std::vector<LoadZone<Real>>& zones) {
  const double s = std::copysign(1.0, stretch);
  const Real& limit = step.to.slip_displacement;
  const Real displacement(step.displacement);
  const Real intercept = displacement - s * limit;
  while (!zones.empty()) {
    const LoadZone<Real>& stuck = zones.back();
    // Excess of the rim over its slip limit, and how fast that falls inward.
    Real excess = s * (displacement - stuck.RestAt(limit));
    if (!(ValueOf(excess) > 0)) excess = Real(0.0);
    const Real rate = Real(1.0) - s * stuck.slope;
    if (ValueOf(excess) < ValueOf(rate) * (ValueOf(limit) - ValueOf(stuck.inner))) {
      const Real width = excess / rate;
      const Real slipping = share(width, limit);
      const Real stuck_slip_force = step.to.slip_force * (Real(1.0) - slipping);
      const Real stuck_force = stuck.force + stuck.slope * (stuck_slip_force - stuck.slip_force);
      zones.push_back({limit - width, Real(s), intercept, stuck_force, stuck_slip_force});
      return stuck_force + s * (step.to.slip_force * slipping);
    }
    zones.pop_back();
  }
  zones.push_back({Real(0.0), Real(s), intercept, Real(0.0), Real(0.0)});
  return s * step.to.slip_force;
}

/// Returns the force after a step; the zones, which cover 0 <= h < δc innermost first, are those
/// after it. docs/theory.md §11 has the rules.
template <typename Real, typename Share>
Real TakeLoadStep(const LoadStep<Real>& step, const Share& share,
                  std::vector<LoadZone<Real>>& zones) {
  const double limit = ValueOf(step.to.slip_displacement);
  if (limit == 0) {
    zones.clear();
    return Real(0.0);
  }
  const double travel = step.displacement - step.from_displacement;
  const double widening = limit - ValueOf(step.from.slip_displacement);
  Real force = step.force;
  if (widening < 0) {
    // The zones that a falling load lifts off lose their history.
    while (ValueOf(zones.back().inner) >= limit) zones.pop_back();
    const double rest = ValueOf(zones.back().RestAt(step.to.slip_displacement));
    force = SlipLoadZones(step, step.displacement - rest, share, zones);
  } else if (widening < std::abs(travel)) {
    force = SlipLoadZones(step, travel, share, zones);
  } else if (widening > 0) {
    const Real slope = Real(travel) / (step.to.slip_displacement - step.from.slip_displacement);
    force = WidenLoadZones(step, slope, zones);
  }
  return Within(force, step.to.slip_force);
}

/// Holds displacement and force at which a contact under a load slips.
struct SlipAtLoad {
  double displacement = 0.0;  // δc(N) [m]
  double force = 0.0;         // Tc(N) [N]

  [[nodiscard]] bool IsInRange() const {
    return displacement <= kLargestPathDisplacement && std::isfinite(force);
  }
};

inline BranchLaw ReferenceLaw(const LoadDependentLaw& law) {
  return {law.reference_stiffness, law.shape_exponent,
          law.friction_coefficient * law.reference_load};
}

/// Returns δc(N_ref) [m].
inline double ReferenceSlipDisplacement(const LoadDependentLaw& law) {
  return GrossSlipDisplacement(ReferenceLaw(law));
}

/// Returns Tc = μN, δc = δc(N_ref)·(N/N_ref)^{1−α}.
inline SlipAtLoad SlipUnder(const LoadDependentLaw& law, double reference_slip_displacement,
                            double normal_load) {
  const double load_ratio = normal_load / law.reference_load;
  double growth = 0.0;
  if (law.shape_exponent == 1.0 / 3) {
    const double root = std::cbrt(load_ratio);
    growth = root * root;
  } else {
    growth = std::pow(load_ratio, 1 - law.shape_exponent);
  }
  return {reference_slip_displacement * growth, law.friction_coefficient * normal_load};
}

/// @throws InvalidArgument unless the load is one and keeps the contact within the range of the
///   arithmetic
inline void RequireLoad(std::string_view quantity, double normal_load, const SlipAtLoad& slip) {
  if (!(normal_load >= 0) || std::isinf(normal_load)) {
    ThrowInvalid(quantity, normal_load, "must be finite and >= 0");
  }
  if (!slip.IsInRange()) {
    ThrowInvalid(quantity, normal_load,
                 "must keep the slip force finite and its displacement <= 1e307 m");
  }
}

}  // namespace mindahl::models
