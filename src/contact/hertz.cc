#include "mindahl/contact/hertz.h"

#include <cmath>
#include <numbers>
#include <string_view>

#include "contact/body_requirements.h"
#include "mindahl/core/error.h"

namespace mindahl {
namespace {

constexpr std::string_view kNormalLoad = "normal load [N]";
constexpr std::string_view kContactRadius = "contact radius [m]";
constexpr std::string_view kEquivalentRadius = "equivalent radius [m]";
constexpr std::string_view kEffectiveModulus = "effective modulus [Pa]";

void RequireElastic(const Body& body) {
  RequirePositive("Young's modulus [Pa]", body.youngs_modulus);
  RequirePoissonRatio("Poisson ratio", body.poisson_ratio);
}

}  // namespace

double ShearModulus(const Body& body) {
  RequireElastic(body);
  return body.youngs_modulus / (2.0 * (1.0 + body.poisson_ratio));
}

double EffectiveModulus(const Body& body_1, const Body& body_2) {
  RequireElastic(body_1);
  RequireElastic(body_2);
  // (1 − ν)(1 + ν) keeps the digits that 1 − ν² loses as ν → −1.
  const double compliance_1 =
      (1.0 - body_1.poisson_ratio) * (1.0 + body_1.poisson_ratio) / body_1.youngs_modulus;
  const double compliance_2 =
      (1.0 - body_2.poisson_ratio) * (1.0 + body_2.poisson_ratio) / body_2.youngs_modulus;
  return 1.0 / (compliance_1 + compliance_2);
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
  const double radius = plane_1   ? radius_2
                        : plane_2 ? radius_1
                                  : radius_1 * (radius_2 / (radius_1 + radius_2));
  if (!(std::isfinite(radius) && radius > 0.0)) {
    ThrowInvalid("relative curvature 1/R1 + 1/R2 [1/m]", 1.0 / radius_1 + 1.0 / radius_2,
                 "must be > 0: a concave seat (negative radius) must be wider than the body in it");
  }
  return radius;
}

double HertzContactRadius(double normal_load, double equivalent_radius, double effective_modulus) {
  RequirePositive(kNormalLoad, normal_load);
  RequirePositive(kEquivalentRadius, equivalent_radius);
  RequirePositive(kEffectiveModulus, effective_modulus);
  return std::cbrt(0.75 * (normal_load / effective_modulus) * equivalent_radius);
}

double HertzEquivalentRadius(double normal_load, double contact_radius, double effective_modulus) {
  RequirePositive(kNormalLoad, normal_load);
  RequirePositive(kContactRadius, contact_radius);
  RequirePositive(kEffectiveModulus, effective_modulus);
  const double mean_pressure_scale = normal_load / (contact_radius * contact_radius);
  return 4.0 * contact_radius * (effective_modulus / mean_pressure_scale) / 3.0;
}

double HertzNormalLoad(double contact_radius, double equivalent_radius, double effective_modulus) {
  RequirePositive(kContactRadius, contact_radius);
  RequirePositive(kEquivalentRadius, equivalent_radius);
  RequirePositive(kEffectiveModulus, effective_modulus);
  const double approach = contact_radius * (contact_radius / equivalent_radius);
  return 4.0 * effective_modulus * contact_radius * approach / 3.0;
}

double HertzMaximumPressure(double normal_load, double contact_radius) {
  RequirePositive(kNormalLoad, normal_load);
  RequirePositive(kContactRadius, contact_radius);
  return 1.5 * normal_load / (std::numbers::pi * contact_radius * contact_radius);
}

double HertzApproach(double contact_radius, double equivalent_radius) {
  RequirePositive(kContactRadius, contact_radius);
  RequirePositive(kEquivalentRadius, equivalent_radius);
  return contact_radius * (contact_radius / equivalent_radius);
}

}  // namespace mindahl
