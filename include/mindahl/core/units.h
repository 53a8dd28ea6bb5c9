#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace mindahl {

/// A unit as a ratio to its SI base: SI value = value · numerator / denominator.
/// Kept as a ratio so that "um" divides by the exact 10⁶ and 17 digits survive.
struct Unit {
  std::string symbol;
  double numerator = 1.0;
  double denominator = 1.0;

  [[nodiscard]] double ToSi(double value) const { return value * numerator / denominator; }
};

/// Finds a unit of the quantity whose base is one of these, by its symbol or another name of it;
/// nullopt where the symbol is none. "µ" may be u:
///   m    m, cm, mm, um/micron, nm, pm, in/inch, ft/feet, mil/thou
///   rad  rad, mrad, deg/°, rev
///   N    N, mN, uN, daN, kN, MN, lbf/lb, kgf/kg, gf/g/grams, kip, dyn; case decides between mN
///        (10⁻³) and MN (10⁶)
///   N m  N m, mN m, uN m, kN m, N mm, lbf in, lbf ft; "Nm", "N·m" and "N*m" are N m
///   s    s/sec, ms, us, ns, min, h
///   Pa   Pa, hPa, kPa, MPa, GPa, mbar, bar, psi, kgf/cm2
std::optional<Unit> FindUnit(std::string_view base, std::string_view symbol);

/// Returns the symbols of units of that base, for messages: "m, mm, um, nm, in".
std::string UnitSymbols(std::string_view base);

/// True for a pressure, which no column is.
inline bool IsPressureUnit(std::string_view symbol) { return FindUnit("Pa", symbol).has_value(); }

/// Reads a number in `unit`, or one with a unit of the same kind: "210GPa" and "2.1e11" in Pa,
/// "50 N", "48 N/um" in N/m; "inf" is a number. Empty where the text is neither.
/// @param unit  N, m, s, Pa, rad, N m, a quotient of two of them, or 1 over one; "-" takes numbers
std::optional<double> ParseQuantity(std::string_view text, std::string_view unit);

/// Returns where the unit of a quantity begins: at its end where it has none.
std::size_t BeginOfUnit(std::string_view text);

}  // namespace mindahl
