#pragma once

#include <limits>

namespace mindahl::contact {

// Hertz contact of two elastic bodies of revolution: a circle of radius a carries the normal load N
// under the pressure p(r) = p₀·√(1 − r²/a²). It holds while a is small against the radii, the
// surfaces are smooth and do not adhere, and both materials stay elastic.
//
// Loads N [N], radii a and ρ [m] and moduli E* [Pa] are finite and > 0; InvalidArgument names the
// one that is not, its value and the rule.
//
// The functions work in long double and round once: where it has 64 bits their relative error is
// below 1 ε = 2.2e-16. A result beyond the normal doubles is refused.

/// One of the two bodies: isotropic elastic, with a spherical surface at the contact.
struct Body {
  double youngs_modulus = 0.0;  ///< E [Pa], finite, > 0
  double poisson_ratio = 0.0;   ///< ν [-], in (−1, 0.5]
  /// R [m], not 0: positive convex, infinite a plane, negative a concave seat
  double radius = std::numeric_limits<double>::infinity();
};

/// Returns the shear modulus [Pa] of an isotropic body.
///   G = E/(2(1 + ν))
/// The radius is not read.
/// @throws InvalidArgument on a modulus that is not > 0 or a Poisson ratio outside (−1, 0.5]
double ShearModulus(const Body& body);

/// Returns the effective modulus E* [Pa] of the pair.
///   1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂
/// Johnson, Contact Mechanics (1985), §4.2. The radii are not read.
/// @throws InvalidArgument as ShearModulus, for either body
double EffectiveModulus(const Body& body_1, const Body& body_2);

/// Returns the equivalent radius ρ [m] of two spherical surfaces.
///   1/ρ = 1/R₁ + 1/R₂
/// Johnson (1985) §4.2.
/// @param radius_1, radius_2  [m], as Body::radius
/// @throws InvalidArgument on a radius that is 0 or not a number, and where the relative curvature
///   is not positive: two planes, or a seat no wider than what sits in it
/// Relative error < 2 ulp, also for R₁ ≈ −R₂: the sum R₁ + R₂ is then exact.
double EquivalentRadius(double radius_1, double radius_2);

/// Returns the radius a [m] of the contact circle.
///   a = ∛(3Nρ/(4E*))
/// Johnson (1985) eq. 4.22.
double HertzContactRadius(double normal_load, double equivalent_radius, double effective_modulus);

/// Returns the equivalent radius ρ [m] under which the load makes a circle of the given radius.
///   ρ = 4E*a³/(3N)
/// The inverse of HertzContactRadius in ρ; a relative error of a counts three times.
double HertzEquivalentRadius(double normal_load, double contact_radius, double effective_modulus);

/// Returns the pressure p₀ [Pa] at the centre of the contact circle, 3/2 of the mean.
///   p₀ = 3N/(2πa²)
/// Johnson (1985) eq. 4.24.
double HertzMaximumPressure(double normal_load, double contact_radius);

}  // namespace mindahl::contact
