#include "mindahl/contact/cattaneo_mindlin.h"

#include <fmt/format.h>

#include <cmath>

#include "contact/requirements.h"
#include "mindahl/core/error.h"

namespace mindahl::contact {
namespace {

/// Returns T₀ for a contact that is known to be valid.
double VirginForce(double slip_force, double gross_slip_displacement, double displacement) {
  const double magnitude = std::abs(displacement);
  if (magnitude >= gross_slip_displacement) return std::copysign(slip_force, displacement);
  const double remaining = (gross_slip_displacement - magnitude) / gross_slip_displacement;
  return slip_force * (displacement / gross_slip_displacement) *
         (1.0 + remaining + remaining * remaining) / (1.0 + remaining * std::sqrt(remaining));
}

}  // namespace

void Validate(const MindlinContact& contact) {
  RequirePositive("contact radius [m]", contact.contact_radius);
  RequirePositive("tangential compliance [1/Pa]", contact.tangential_compliance);
  RequirePositive("slip force [N]", contact.slip_force);
}

double TangentialCompliance(const Body& body_1, const Body& body_2) {
  const auto compliance = [](const Body& body) {
    return (2.0L - body.poisson_ratio) / ShearModulus(body);
  };
  return InRange("tangential compliance [1/Pa]", compliance(body_1) + compliance(body_2));
}

double GrossSlipForce(double friction_coefficient, double normal_load) {
  RequirePositive("friction coefficient", friction_coefficient);
  RequirePositive("normal load [N]", normal_load);
  return InRange("slip force [N]", static_cast<long double>(friction_coefficient) * normal_load);
}

double MindlinTangentialStiffness(double contact_radius, double tangential_compliance) {
  RequirePositive("contact radius [m]", contact_radius);
  RequirePositive("tangential compliance [1/Pa]", tangential_compliance);
  return InRange("tangential stiffness [N/m]", 8.0L * contact_radius / tangential_compliance);
}

double GrossSlipDisplacement(const MindlinContact& contact) {
  Validate(contact);
  return InRange(
      "gross-slip displacement [m]",
      3.0L * contact.slip_force * contact.tangential_compliance / (16.0L * contact.contact_radius));
}

double MindlinVirginForce(const MindlinContact& contact, double displacement) {
  RequireFinite("displacement [m]", displacement);
  return VirginForce(contact.slip_force, GrossSlipDisplacement(contact), displacement);
}

double MindlinUnloadingForce(const MindlinContact& contact, double displacement,
                             double displacement_amplitude) {
  const double gross_slip_displacement = GrossSlipDisplacement(contact);
  RequireNonNegative("displacement amplitude [m]", displacement_amplitude);
  if (!(std::abs(displacement) <= displacement_amplitude)) {
    ThrowInvalid(
        "displacement [m]", displacement,
        fmt::format("must not exceed the displacement amplitude {} m", displacement_amplitude));
  }
  const double half_retreat = 0.5 * displacement_amplitude - 0.5 * displacement;
  return VirginForce(contact.slip_force, gross_slip_displacement, displacement_amplitude) -
         2.0 * VirginForce(contact.slip_force, gross_slip_displacement, half_retreat);
}

double MindlinReloadingForce(const MindlinContact& contact, double displacement,
                             double displacement_amplitude) {
  return -MindlinUnloadingForce(contact, -displacement, displacement_amplitude);
}

}  // namespace mindahl::contact
