#pragma once

#include <string_view>

namespace mindahl::report {

/// What a report's numbers are in: those of a force along the contact, or of a torque about it.
struct Units {
  std::string_view force = "N";
  std::string_view displacement = "m";
  std::string_view stiffness = "N/m";
  std::string_view drift = "N/s";
  std::string_view viscous = "N s/m";
};

inline constexpr Units kUnitsOfForce{};
inline constexpr Units kUnitsOfTorque{.force = "N m",
                                      .displacement = "rad",
                                      .stiffness = "N m/rad",
                                      .drift = "N m/s",
                                      .viscous = "N m s/rad"};

/// The unit in which a quantity is that has `unit` where the record has a force: "N/m" is N m/rad
/// of a torque. Energies are in J either way.
constexpr std::string_view UnitIn(const Units& units, std::string_view unit) {
  if (unit == kUnitsOfForce.force) return units.force;
  if (unit == kUnitsOfForce.displacement) return units.displacement;
  if (unit == kUnitsOfForce.stiffness) return units.stiffness;
  if (unit == kUnitsOfForce.drift) return units.drift;
  if (unit == kUnitsOfForce.viscous) return units.viscous;
  return unit;
}

}  // namespace mindahl::report
