#include "mindahl/contact/hertz.h"

#include <cmath>
#include <numbers>

#include "contact/requirements.h"
#include "mindahl/core/error.h"

namespace mindahl::contact {
namespace {

void RequireElastic(const Body& body) {
  RequirePositive("Young's modulus [Pa]", body.youngs_modulus);
  RequirePoissonRatio("Poisson ratio", body.poisson_ratio);
}

}  // namespace

double ShearModulus(const Body& body) {
  RequireElastic(body);
  const long double ratio = body.poisson_ratio;
  return InRange("shear modulus [Pa]", body.youngs_modulus / (2 * (1 + ratio)));
}

double EffectiveModulus(const Body& body_1, const Body& body_2) {
  RequireElastic(body_1);
  RequireElastic(body_2);
  // (1 − ν)(1 + ν) keeps the digits that 1 − ν² loses as ν → −1.
  const auto compliance = [](const Body& body) {
    const long double ratio = body.poisson_ratio;
    return (1 - ratio) * (1 + ratio) / body.youngs_modulus;
  };
  return InRange("effective modulus [Pa]", 1 / (compliance(body_1) + compliance(body_2)));
}

double EquivalentRadius(double radius_1, double radius_2) {
  RequireSurfaceRadius("radius of body 1 [m]", radius_1);
  RequireSurfaceRadius("radius of body 2 [m]", radius_2);
  const bool plane_1 = std::isinf(radius_1);
  const bool plane_2 = std::isinf(radius_2);
  if (plane_1 && plane_2) {
    ThrowInvalid(
        "relative curvature 1/R1 + 1/R2 [1/m]", 0.0,
        "must be > 0: two planes make no Hertz contact, at least one radius must be finite");
  }
  // Positive when R₁ + R₂ has the sign of R₁·R₂; the sum is exact when they nearly cancel.
  const double sum = radius_1 + radius_2;
  const double radius = plane_1    ? radius_2
                        : plane_2  ? radius_1
                        : sum == 0 ? std::numeric_limits<double>::infinity()
                                   : radius_1 * (radius_2 / sum);
  if (!(std::isfinite(radius) && radius > 0.0)) {
    ThrowInvalid("relative curvature 1/R1 + 1/R2 [1/m]", 1.0 / radius_1 + 1.0 / radius_2,
                 "must be > 0: a concave seat (negative radius) must be wider than the body in it");
  }
  return radius;
}

double HertzContactRadius(double normal_load, double equivalent_radius, double effective_modulus) {
  RequirePositive("normal load [N]", normal_load);
  RequirePositive("equivalent radius [m]", equivalent_radius);
  RequirePositive("effective modulus [Pa]", effective_modulus);
  const long double load = normal_load;
  return InRange("contact radius [m]",
                 std::cbrt(0.75L * load * equivalent_radius / effective_modulus));
}

double HertzEquivalentRadius(double normal_load, double contact_radius, double effective_modulus) {
  RequirePositive("normal load [N]", normal_load);
  RequirePositive("contact radius [m]", contact_radius);
  RequirePositive("effective modulus [Pa]", effective_modulus);
  const long double radius = contact_radius;
  return InRange("equivalent radius [m]",
                 4 * effective_modulus * (radius * radius * radius) / (3.0L * normal_load));
}

double HertzMaximumPressure(double normal_load, double contact_radius) {
  RequirePositive("normal load [N]", normal_load);
  RequirePositive("contact radius [m]", contact_radius);
  const long double radius = contact_radius;
  return InRange("maximum pressure [Pa]",
                 1.5L * normal_load / (std::numbers::pi_v<long double> * radius * radius));
}

}  // namespace mindahl::contact
