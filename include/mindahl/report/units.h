#pragma once

#include <string_view>

namespace mindahl::report {

/// Holds the units of a report: those of a force along the contact, or of a torque about it.
struct Units {
  std::string_view force = "N";
  std::string_view displacement = "m";
  std::string_view stiffness = "N/m";
  std::string_view drift = "N/s";
  std::string_view viscous = "N s/m";
  std::string_view compliance = "m/N";
  std::string_view inertia = "kg";
  std::string_view displacement_drift = "m/s";
  std::string_view response = "N";    ///< the channel that is fitted: of residuals
  std::string_view excitation = "m";  ///< the other one: of reversals
};

// Units of fields that are those of a channel: which it is, a report knows.
inline constexpr const char* kOfResponse = "N or m";
inline constexpr const char* kOfExcitation = "m or N";

inline constexpr Units kUnitsOfForce{};
inline constexpr Units kUnitsOfTorque{.force = "N m",
                                      .displacement = "rad",
                                      .stiffness = "N m/rad",
                                      .drift = "N m/s",
                                      .viscous = "N m s/rad",
                                      .compliance = "rad/(N m)",
                                      .inertia = "kg m²",
                                      .displacement_drift = "rad/s",
                                      .response = "N m",
                                      .excitation = "rad"};

/// Returns the unit in which a quantity is that has `unit` where the record has a force: "N/m" is N
/// m/rad of a torque. Energies are in J either way.
constexpr std::string_view UnitIn(const Units& units, std::string_view unit) {
  if (unit == kUnitsOfForce.force) return units.force;
  if (unit == kUnitsOfForce.displacement) return units.displacement;
  if (unit == kUnitsOfForce.stiffness) return units.stiffness;
  if (unit == kUnitsOfForce.drift) return units.drift;
  if (unit == kUnitsOfForce.viscous) return units.viscous;
  if (unit == kUnitsOfForce.compliance) return units.compliance;
  if (unit == kUnitsOfForce.inertia) return units.inertia;
  if (unit == kUnitsOfForce.displacement_drift) return units.displacement_drift;
  if (unit == kOfResponse) return units.response;
  if (unit == kOfExcitation) return units.excitation;
  return unit;
}

}  // namespace mindahl::report
