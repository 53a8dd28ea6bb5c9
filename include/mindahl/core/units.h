#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace mindahl {

/// Names what a unit measures.
enum class Dimension { kLength, kAngle, kForce, kTorque, kTime, kPressure };

/// A unit as a ratio to its SI base: SI value = value · numerator / denominator.
/// Kept as a ratio so that "um" divides by the exact 10⁶ and 17 digits survive.
struct Unit {
  std::string symbol;
  Dimension dimension = Dimension::kLength;
  double numerator = 1.0;
  double denominator = 1.0;

  [[nodiscard]] double ToSi(double value) const { return value * numerator / denominator; }
};

/// Finds a unit by its symbol or another way to write it; nullopt where it is not known.
///   length    m, cm, mm, um/µm/micron, nm, pm, in/inch, ft/feet, mil/thou
///   angle     rad, mrad, deg/°, rev
///   force     N, mN, uN/µN, cN, daN, kN, MN, lbf/lb, kgf/kg, gf/g/grams, kip, dyn, ozf/oz
///   torque    a force by a length: N m, kgf cm, lbf in; "Nm", "N·m", "N*m" and "N-m" are N m
///   time      s/sec, ms, us/µs, ns, min, h
///   pressure  Pa, hPa, kPa, MPa, GPa, mbar, bar, psi, kgf/cm2
/// Case decides between mN (10⁻³) and MN (10⁶).
std::optional<Unit> FindUnit(std::string_view symbol);

/// Returns the symbols of a dimension, the SI unit first, for messages: "m, mm, um, nm, in".
std::string UnitSymbols(Dimension dimension);

/// Reads a number in `unit`, or one with a unit of the same kind: "210GPa" and "2.1e11" in Pa,
/// "50 N", "48 N/um" in N/m; "inf" is a number. Empty where the text is neither.
/// @param unit  N, m, s, Pa, rad, N m, a quotient of two of them, or 1 over one; "-" takes
///   numbers and per cent
std::optional<double> ParseQuantity(std::string_view text, std::string_view unit);

/// Returns where the unit of a quantity begins: at its end where it has none.
std::size_t BeginOfUnit(std::string_view text);

}  // namespace mindahl
