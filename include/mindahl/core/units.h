#pragma once

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

/// m, mm, um/µm, nm, in; nullopt when the symbol is not a length.
std::optional<Unit> LengthUnit(std::string_view symbol);

/// N, mN, uN/µN, kN, MN, lbf, kgf; case decides between mN (10⁻³) and MN (10⁶).
std::optional<Unit> ForceUnit(std::string_view symbol);

/// s, ms, us/µs, min.
std::optional<Unit> TimeUnit(std::string_view symbol);

/// The accepted symbols, for messages: "m, mm, um, nm, in".
std::string LengthUnitSymbols();
std::string ForceUnitSymbols();
std::string TimeUnitSymbols();

}  // namespace mindahl
