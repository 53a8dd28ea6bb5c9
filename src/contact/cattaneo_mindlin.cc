#include "mindahl/contact/cattaneo_mindlin.h"

#include <fmt/format.h>

#include <cmath>

#include "contact/known_contact.h"
#include "mindahl/core/error.h"

namespace mindahl::contact {
namespace {

void RequireWithinSlipForce(double tangential_force, double slip_force) {
  RequirePositive("slip force [N]", slip_force);
  if (!(std::abs(tangential_force) <= slip_force)) {
    ThrowInvalid("tangential force [N]", tangential_force,
                 fmt::format("must not exceed the slip force {} N", slip_force));
  }
}

void RequirePeakForce(double peak_force, double slip_force) {
  if (!(peak_force >= 0.0 && peak_force <= slip_force)) {
    ThrowInvalid("peak force [N]", peak_force,
                 fmt::format("must be >= 0 and must not exceed the slip force {} N", slip_force));
  }
}

/// Returns 1 − (1 − t)^{2/3} without cancellation at either end. The two fractions of Tc, which add
/// up to 1, come separately: as t → 1 the root needs every digit of the second.
double SlipShare(double force_share, double remaining_share) {
  const double stick_ratio = std::cbrt(remaining_share);
  return force_share * (1.0 + stick_ratio) / (1.0 + stick_ratio + stick_ratio * stick_ratio);
}

/// Returns (1 + 3s + s²)·(1 − s)³, given s and 1 − s.
double EnergyShare(double stick_ratio, double one_minus_stick_ratio) {
  return (1.0 + 3.0 * stick_ratio + stick_ratio * stick_ratio) * one_minus_stick_ratio *
         one_minus_stick_ratio * one_minus_stick_ratio;
}

/// Loss per cycle [J] at the onset of gross slip.
double EnergyAtGrossSlip(const MindlinContact& contact) {
  return InRange("energy per cycle at gross slip [J]",
                 3.0L * contact.slip_force * contact.slip_force * contact.tangential_compliance /
                     (20.0L * contact.contact_radius));
}

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

double StickRadiusRatio(double tangential_force, double slip_force) {
  RequireWithinSlipForce(tangential_force, slip_force);
  return std::cbrt((slip_force - std::abs(tangential_force)) / slip_force);
}

double SlipAreaFraction(double tangential_force, double slip_force) {
  RequireWithinSlipForce(tangential_force, slip_force);
  const double magnitude = std::abs(tangential_force);
  return SlipShare(magnitude / slip_force, (slip_force - magnitude) / slip_force);
}

double MindlinVirginDisplacement(const MindlinContact& contact, double tangential_force) {
  const double gross_slip_displacement = GrossSlipDisplacement(contact);
  return std::copysign(
      gross_slip_displacement * SlipAreaFraction(tangential_force, contact.slip_force),
      tangential_force);
}

double MindlinUnloadingDisplacement(const MindlinContact& contact, double tangential_force,
                                    double peak_force) {
  const double gross_slip_displacement = GrossSlipDisplacement(contact);
  RequirePeakForce(peak_force, contact.slip_force);
  if (!(std::abs(tangential_force) <= peak_force)) {
    ThrowInvalid("tangential force [N]", tangential_force,
                 fmt::format("must not exceed the peak force {} N", peak_force));
  }
  const double slip_force = contact.slip_force;
  // 1 − (T* − T)/(2Tc) as a sum of two differences that are exact where they are small.
  const double remaining_share =
      ((slip_force - peak_force) + (slip_force + tangential_force)) / (2.0 * slip_force);
  const double force_share = (peak_force - tangential_force) / (2.0 * slip_force);
  return gross_slip_displacement *
         (SlipAreaFraction(peak_force, slip_force) - 2.0 * SlipShare(force_share, remaining_share));
}

double MindlinReloadingDisplacement(const MindlinContact& contact, double tangential_force,
                                    double peak_force) {
  return -MindlinUnloadingDisplacement(contact, -tangential_force, peak_force);
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

double MindlinEnergyPerCycle(const MindlinContact& contact, double peak_force) {
  Validate(contact);
  RequirePeakForce(peak_force, contact.slip_force);
  const double stick_ratio = StickRadiusRatio(peak_force, contact.slip_force);
  const double one_minus_stick_ratio =
      (peak_force / contact.slip_force) / (1.0 + stick_ratio + stick_ratio * stick_ratio);
  return EnergyAtGrossSlip(contact) * EnergyShare(stick_ratio, one_minus_stick_ratio);
}

double MindlinEnergyPerCycleAtAmplitude(const MindlinContact& contact,
                                        double displacement_amplitude) {
  const double gross_slip_displacement = GrossSlipDisplacement(contact);
  RequireNonNegative("displacement amplitude [m]", displacement_amplitude);
  const double energy_at_gross_slip = EnergyAtGrossSlip(contact);
  if (displacement_amplitude > gross_slip_displacement) {
    return energy_at_gross_slip +
           4.0 * contact.slip_force * (displacement_amplitude - gross_slip_displacement);
  }
  const double stick_ratio =
      std::sqrt((gross_slip_displacement - displacement_amplitude) / gross_slip_displacement);
  const double one_minus_stick_ratio =
      (displacement_amplitude / gross_slip_displacement) / (1.0 + stick_ratio);
  return energy_at_gross_slip * EnergyShare(stick_ratio, one_minus_stick_ratio);
}

}  // namespace mindahl::contact
