#include "mindahl/core/units.h"

#include <algorithm>
#include <array>
#include <span>

namespace mindahl {
namespace {

struct Entry {
  std::string_view symbol;
  double numerator;
  double denominator;
};

constexpr std::array kLengths = {
    Entry{"m", 1, 1},    Entry{"mm", 1, 1e3},   Entry{"um", 1, 1e6},
    Entry{"nm", 1, 1e9}, Entry{"in", 254, 1e4},
};
constexpr std::array kForces = {
    Entry{"N", 1, 1},         Entry{"mN", 1, 1e3}, Entry{"uN", 1, 1e6},
    Entry{"kN", 1e3, 1},      Entry{"MN", 1e6, 1}, Entry{"lbf", 4.4482216152605, 1},
    Entry{"kgf", 9.80665, 1},
};
constexpr std::array kTimes = {
    Entry{"s", 1, 1},
    Entry{"ms", 1, 1e3},
    Entry{"us", 1, 1e6},
    Entry{"min", 60, 1},
};

/// "µ" has two code points, U+00B5 and U+03BC; both become "u".
std::string WithAsciiMicro(std::string_view symbol) {
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
std::optional<Unit> ForceUnit(std::string_view symbol) { return Find(kForces, symbol); }
std::optional<Unit> TimeUnit(std::string_view symbol) { return Find(kTimes, symbol); }

std::string LengthUnitSymbols() { return Symbols(kLengths); }
std::string ForceUnitSymbols() { return Symbols(kForces); }
std::string TimeUnitSymbols() { return Symbols(kTimes); }

}  // namespace mindahl
