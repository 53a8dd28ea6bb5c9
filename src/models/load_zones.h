#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/AutoDiff>
#include <vector>

#include "mindahl/models/backbone.h"
#include "models/normalized_response.h"

namespace mindahl::models {

// Friction under a normal load N that varies along the path, as docs/theory.md §11 derives it:
// elements in parallel, of which element h is in contact while δc(N) > h, sticks elastically, and
// slips at |δ − r| = δc(N) − h, with r the displacement at which it carries nothing.

/// Elements from `inner` outward, to the next zone or the rim, whose rest positions lie on the
/// line r(h) = intercept + slope·h. Real is double, or has derivatives.
template <typename Real>
struct LoadZone {
  Real inner{};       ///< h₁ [m]
  Real slope{};       ///< r' [–], within ±1; ±1 where the last slip was in that direction
  Real intercept{};   ///< r(0) [m], of the line
  Real force{};       ///< Σ r'·ΔTc [N] over the zones within
  Real slip_force{};  ///< Tc(h₁) [N]

  [[nodiscard]] Real RestAt(const Real& h) const { return intercept + slope * h; }
};

/// The rim of the contact under a load.
template <typename Real>
struct LoadRim {
  Real slip_displacement{};  ///< δc(N) [m], of the outermost elements
  Real slip_force{};         ///< Tc(N) [N]
};

/// A number with its derivatives by the first three of ResponseParameter, ln κ, α and δ₀, for
/// arithmetic that takes them along.
using Tangent = Eigen::AutoDiffScalar<Eigen::Vector3d>;

/// Returns the number without its derivatives, which alone decides between cases.
inline double ValueOf(double x) { return x; }
inline double ValueOf(const Tangent& x) { return x.value(); }

/// A contact under a load that is moved from step to step.
template <typename Real>
struct ZonedContact {
  /// @param at_rest  displacement [m] at which it is unloaded, and where it begins
  ZonedContact(const LoadRim<Real>& first_rim, const Real& at_rest)
      : rim(first_rim), displacement(ValueOf(at_rest)) {
    if (!(ValueOf(rim.slip_displacement) > 0)) return;
    zones.push_back({Real(0.0), Real(0.0), at_rest, Real(0.0), Real(0.0)});
  }

  /// Cover 0 <= h < δc, innermost first; the elements at the rim carry nothing, so that δ need not
  /// be kept with them.
  std::vector<LoadZone<Real>> zones;
  LoadRim<Real> rim;
  double displacement;  ///< δ [m]
  Real force{0.0};      ///< T [N]
};

/// Fraction of the slip force that an annulus of some width carries: φ(y), y = width/(δc·β).
template <typename Shape>
struct ShareOfWidth {
  Shape shape;
  double shape_exponent;

  double operator()(double width, double slip_displacement) const {
    return shape.Force(width / (slip_displacement * (1 - shape_exponent)));
  }
  Tangent operator()(const Tangent& width, const Tangent& slip_displacement) const {
    const Tangent remaining(1 - shape_exponent, -Eigen::Vector3d::Unit(kShape));
    const Tangent y = width / (slip_displacement * remaining);
    const auto phi = backbone::Differentiate(y.value(), shape_exponent);
    Tangent share(phi.force, phi.slope * y.derivatives());
    share.derivatives()[kShape] += phi.shape_derivative;
    return share;
  }
};

/// The load rises faster than anything can slip: elements come into contact at the rim, each
/// resting where δ is when it does. On the line of those before it makes no zone of its own.
template <typename Real>
Real WidenLoadZones(const LoadRim<Real>& to, double displacement, ZonedContact<Real>& contact) {
  const LoadRim<Real>& from = contact.rim;
  const Real slope =
      Real(displacement - contact.displacement) / (to.slip_displacement - from.slip_displacement);
  const Real intercept = Real(contact.displacement) - slope * from.slip_displacement;
  const bool goes_on = !contact.zones.empty() &&
                       ValueOf(contact.zones.back().slope) == ValueOf(slope) &&
                       ValueOf(contact.zones.back().intercept) == ValueOf(intercept);
  if (!goes_on) {
    contact.zones.push_back(
        {from.slip_displacement, slope, intercept, contact.force, from.slip_force});
  }
  return contact.force + slope * (to.slip_force - from.slip_force);
}

/// An annulus slips to the rest positions δ − s·(δc − h), s the sign of `stretch`, which is δ − r
/// at the rim. As |r'| <= 1, what slips is outside of what sticks.
template <typename Real, typename Share>
Real SlipLoadZones(const LoadRim<Real>& to, double at, double stretch, const Share& share,
                   std::vector<LoadZone<Real>>& zones) {
  const double s = std::copysign(1.0, stretch);
  const Real& limit = to.slip_displacement;
  const Real displacement(at);
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
      const Real stuck_slip_force = to.slip_force * (Real(1.0) - slipping);
      const Real stuck_force = stuck.force + stuck.slope * (stuck_slip_force - stuck.slip_force);
      zones.push_back({limit - width, Real(s), intercept, stuck_force, stuck_slip_force});
      return stuck_force + s * (to.slip_force * slipping);
    }
    zones.pop_back();
  }
  zones.push_back({Real(0.0), Real(s), intercept, Real(0.0), Real(0.0)});
  return s * to.slip_force;
}

/// Moves a contact straight in (δ, δc) to a displacement under a rim. docs/theory.md §11 has the
/// rules. If adding a zone runs out of memory none has been dropped.
/// @param share  (width, δc) of an annulus to the fraction of the slip force that it carries
template <typename Real, typename Share>
void MoveTo(const LoadRim<Real>& to, double displacement, const Share& share,
            ZonedContact<Real>& contact) {
  const double limit = ValueOf(to.slip_displacement);
  const double travel = displacement - contact.displacement;
  const double widening = limit - ValueOf(contact.rim.slip_displacement);
  Real force = contact.force;
  if (limit == 0) {
    contact.zones.clear();
    force = Real(0.0);
  } else if (widening < 0) {
    // The zones that a falling load lifts off lose their history.
    while (ValueOf(contact.zones.back().inner) >= limit) contact.zones.pop_back();
    const double rest = ValueOf(contact.zones.back().RestAt(to.slip_displacement));
    force = SlipLoadZones(to, displacement, displacement - rest, share, contact.zones);
  } else if (widening < std::abs(travel)) {
    force = SlipLoadZones(to, displacement, travel, share, contact.zones);
  } else if (widening > 0) {
    force = WidenLoadZones(to, displacement, contact);
  }
  contact.force = std::clamp(force, Real(-to.slip_force), to.slip_force);
  contact.rim = to;
  contact.displacement = displacement;
}

}  // namespace mindahl::models
