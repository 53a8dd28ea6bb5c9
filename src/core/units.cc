#include "mindahl/core/units.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <span>

namespace mindahl {
namespace {

struct Entry {
  std::string_view symbol;
  double numerator;
  double denominator;
};

constexpr std::array kLengths = {
    Entry{"m", 1, 1},    Entry{"mm", 1, 1e3},   Entry{"um", 1, 1e6},    Entry{"nm", 1, 1e9},
    Entry{"cm", 1, 1e2}, Entry{"in", 254, 1e4}, Entry{"ft", 3048, 1e4}, Entry{"mil", 254, 1e7},
};
constexpr std::array kForces = {
    Entry{"N", 1, 1},          Entry{"mN", 1, 1e3},
    Entry{"uN", 1, 1e6},       Entry{"kN", 1e3, 1},
    Entry{"MN", 1e6, 1},       Entry{"lbf", 4.4482216152605, 1},
    Entry{"kgf", 9.80665, 1},  Entry{"kip", 4448.2216152605, 1},
    Entry{"gf", 9.80665, 1e3}, Entry{"daN", 10, 1},
};
constexpr std::array kAngles = {
    Entry{"rad", 1, 1},
    Entry{"mrad", 1, 1e3},
    Entry{"deg", std::numbers::pi, 180},
    Entry{"rev", 2 * std::numbers::pi, 1},
};
constexpr std::array kTorques = {
    Entry{"N m", 1, 1},
    Entry{"mN m", 1, 1e3},
    Entry{"uN m", 1, 1e6},
    Entry{"kN m", 1e3, 1},
    Entry{"N mm", 1, 1e3},
    Entry{"lbf in", 4.4482216152605 * 0.0254, 1},
    Entry{"lbf ft", 4.4482216152605 * 0.3048, 1},
};
constexpr std::array kTimes = {
    Entry{"s", 1, 1},
    Entry{"ms", 1, 1e3},
    Entry{"us", 1, 1e6},
    Entry{"min", 60, 1},
};

struct Synonym {
  std::string_view written;
  std::string_view symbol;
};
// A mass that stands for a force is its weight.
constexpr std::array kSynonyms = {
    Synonym{"micron", "um"}, Synonym{"microns", "um"}, Synonym{"inch", "in"},
    Synonym{"Inch", "in"},   Synonym{"inches", "in"},  Synonym{"\"", "in"},
    Synonym{"feet", "ft"},   Synonym{"thou", "mil"},   Synonym{"g", "gf"},
    Synonym{"kg", "kgf"},    Synonym{"kp", "kgf"},     Synonym{"lb", "lbf"},
    Synonym{"lbs", "lbf"},   Synonym{"kips", "kip"},   Synonym{"sec", "s"},
    Synonym{"msec", "ms"},
};

/// "µ" has two code points, U+00B5 and U+03BC; both become "u".
std::string WithAsciiMicro(std::string_view symbol) {
  const auto synonym = std::ranges::find(kSynonyms, symbol, &Synonym::written);
  if (synonym != kSynonyms.end()) return std::string(synonym->symbol);
  for (const std::string_view micro : {"\u00b5", "\u03bc"}) {
    if (symbol.starts_with(micro)) return std::string("u").append(symbol.substr(micro.size()));
  }
  return std::string(symbol);
}

std::optional<Unit> Find(std::span<const Entry> table, std::string_view symbol) {
  const std::string wanted = WithAsciiMicro(symbol);
  const auto entry = std::ranges::find(table, wanted, &Entry::symbol);
  if (entry == table.end()) return std::nullopt;
  return Unit{wanted, entry->numerator, entry->denominator};
}

/// Returns "Nm", "N·m", "N*m" and "N-m" as the table has it, "N m".
std::string WithBlank(std::string_view symbol) {
  std::string letters = WithAsciiMicro(symbol);
  for (const std::string_view sign : {"·", "⋅", "*", "-", " "}) {
    for (std::size_t at = letters.find(sign); at != std::string::npos; at = letters.find(sign)) {
      letters.erase(at, sign.size());
    }
  }
  for (const Entry& entry : kTorques) {
    std::string joined(entry.symbol);
    std::erase(joined, ' ');
    if (joined == letters) return std::string(entry.symbol);
  }
  return std::string(symbol);
}

std::string Symbols(std::span<const Entry> table) {
  std::string result;
  for (const Entry& entry : table) {
    if (!result.empty()) result += ", ";
    result += entry.symbol;
  }
  return result;
}

}  // namespace

std::optional<Unit> LengthUnit(std::string_view symbol) { return Find(kLengths, symbol); }
std::optional<Unit> AngleUnit(std::string_view symbol) {
  return Find(kAngles, symbol == "°" ? "deg" : symbol);
}
std::optional<Unit> TorqueUnit(std::string_view symbol) {
  return Find(kTorques, WithBlank(symbol));
}
std::optional<Unit> ForceUnit(std::string_view symbol) { return Find(kForces, symbol); }
bool IsPressureUnit(std::string_view symbol) {
  constexpr std::array<std::string_view, 10> kPressures = {
      "Pa", "hPa", "kPa", "MPa", "GPa", "mbar", "bar", "psi", "kgf/cm2", "kgf/cm²"};
  return std::ranges::find(kPressures, symbol) != kPressures.end();
}
std::optional<Unit> TimeUnit(std::string_view symbol) { return Find(kTimes, symbol); }

std::string LengthUnitSymbols() { return Symbols(kLengths); }
std::string AngleUnitSymbols() { return Symbols(kAngles); }
std::string TorqueUnitSymbols() { return Symbols(kTorques); }
std::string ForceUnitSymbols() { return Symbols(kForces); }
std::string TimeUnitSymbols() { return Symbols(kTimes); }

}  // namespace mindahl
