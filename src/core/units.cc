#include "mindahl/core/units.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <span>
#include <vector>

#include "core/from_chars.h"
#include "core/text.h"

namespace mindahl {
namespace {

struct Entry {
  std::string_view symbol;
  double numerator;
  double denominator;
  /// Other ways to write it, between blanks; in lower case they count in any.
  std::string_view words = {};
};

constexpr std::array kLengths = {
    Entry{"m", 1, 1, "meter meters metre metres м"},
    Entry{"mm", 1, 1e3, "MM millimeter millimeters millimetre millimetres 毫米 мм"},
    Entry{"um", 1, 1e6, "micron microns micrometer micrometers micrometre 微米 мкм"},
    Entry{"nm", 1, 1e9},
    Entry{"cm", 1, 1e2},
    Entry{"in", 254, 1e4, "inch inches \""},
    Entry{"ft", 3048, 1e4, "feet"},
    Entry{"mil", 254, 1e7, "thou"},
    Entry{"pm", 1, 1e12},
};
// A mass that stands for a force is its weight.
constexpr std::array kForces = {
    Entry{"N", 1, 1, "newton newtons 牛 Н"},
    Entry{"mN", 1, 1e3},
    Entry{"uN", 1, 1e6},
    Entry{"kN", 1e3, 1, "KN kilonewton kilonewtons 千牛 кН"},
    Entry{"MN", 1e6, 1},
    Entry{"lbf", 4.4482216152605, 1, "lb lbs pounds"},
    Entry{"kgf", 9.80665, 1, "kg kp"},
    Entry{"kip", 4448.2216152605, 1, "kips"},
    Entry{"gf", 9.80665, 1e3, "g gram grams gramm"},
    Entry{"daN", 10, 1},
    Entry{"dyn", 1, 1e5, "dyne dynes"},
};
constexpr std::array kAngles = {
    Entry{"rad", 1, 1, "radian radians"},
    Entry{"mrad", 1, 1e3},
    Entry{"deg", std::numbers::pi, 180, "° degree degrees 度"},
    Entry{"rev", 2 * std::numbers::pi, 1, "revolutions"},
};
constexpr std::array kTorques = {
    Entry{"N m", 1, 1, "Nm N·m N⋅m N*m N-m"},
    Entry{"mN m", 1, 1e3, "mNm mN·m mN⋅m mN*m mN-m"},
    Entry{"uN m", 1, 1e6, "uNm uN·m uN⋅m uN*m uN-m"},
    Entry{"kN m", 1e3, 1, "kNm kN·m kN⋅m kN*m kN-m"},
    Entry{"N mm", 1, 1e3, "Nmm N·mm N⋅mm N*mm N-mm"},
    Entry{"lbf in", 4.4482216152605 * 0.0254, 1, "lbfin lbf·in lbf⋅in lbf*in lbf-in"},
    Entry{"lbf ft", 4.4482216152605 * 0.3048, 1, "lbfft lbf·ft lbf⋅ft lbf*ft lbf-ft"},
};
constexpr std::array kTimes = {
    Entry{"s", 1, 1, "sec secs second seconds sek seg 秒 с"},
    Entry{"ms", 1, 1e3, "msec 毫秒 milliseconds millis"},
    Entry{"us", 1, 1e6, "usec"},
    Entry{"ns", 1, 1e9, "nsec"},
    Entry{"min", 60, 1, "minute minutes"},
    Entry{"h", 3600, 1, "hour hours hr"},
};
constexpr std::array kPressures = {
    Entry{"Pa", 1, 1},
    Entry{"hPa", 1e2, 1},
    Entry{"kPa", 1e3, 1},
    Entry{"MPa", 1e6, 1},
    Entry{"GPa", 1e9, 1},
    Entry{"mbar", 1e2, 1},
    Entry{"bar", 1e5, 1},
    Entry{"psi", 6894.757293168, 1},
    Entry{"kgf/cm2", 98066.5, 1, "kgf/cm²"},
};

struct UnitsOfBase {
  std::string_view base;
  std::span<const Entry> units;
};
constexpr std::array kBases = {UnitsOfBase{"m", kLengths}, UnitsOfBase{"rad", kAngles},
                               UnitsOfBase{"N", kForces},  UnitsOfBase{"N m", kTorques},
                               UnitsOfBase{"s", kTimes},   UnitsOfBase{"Pa", kPressures}};

/// Returns the units of a base; none of another word.
std::span<const Entry> UnitsOf(std::string_view base) {
  const auto found = std::ranges::find(kBases, base, &UnitsOfBase::base);
  return found == kBases.end() ? std::span<const Entry>() : found->units;
}

/// "µ" has two code points, U+00B5 and U+03BC; both become "u".
std::string WithAsciiMicro(std::string_view symbol) {
  for (const std::string_view micro : {"\u00b5", "\u03bc"}) {
    if (symbol.starts_with(micro)) return std::string("u").append(symbol.substr(micro.size()));
  }
  return std::string(symbol);
}

std::string_view WithoutBlanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Returns a value in a unit's base from one in `symbol`; empty where that is of another kind.
std::optional<double> InBaseOf(double value, std::string_view symbol, std::string_view base) {
  if (const std::optional<Unit> unit = FindUnit(base, symbol)) return unit->ToSi(value);
  return symbol == base && base != "-" ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<Unit> FindUnit(std::string_view base, std::string_view symbol) {
  const std::string ascii = WithAsciiMicro(symbol);
  const std::string lower = LowerCase(symbol);
  const auto is_it = [&](const Entry& entry) {
    if (entry.symbol == ascii) return true;
    const std::vector<std::string_view> words = PartsOf(entry.words, ' ');
    // A single letter, or two, differ by their case: g and G, mN and MN.
    return std::ranges::find(words, ascii) != words.end() ||
           (symbol.size() >= 3 && std::ranges::find(words, lower) != words.end());
  };
  const std::span<const Entry> units = UnitsOf(base);
  const auto entry = symbol.empty() ? units.end() : std::ranges::find_if(units, is_it);
  if (entry == units.end()) return std::nullopt;
  return Unit{std::string(entry->symbol), entry->numerator, entry->denominator};
}

std::string UnitSymbols(std::string_view base) {
  std::string result;
  for (const Entry& entry : UnitsOf(base)) {
    if (!result.empty()) result += ", ";
    result += entry.symbol;
  }
  return result;
}

std::size_t BeginOfUnit(std::string_view text) {
  double value = 0.0;
  std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
  if (begin < text.size() && text[begin] == '+') ++begin;
  const auto [stop, error] = FromChars(text.data() + begin, text.data() + text.size(), value);
  if (error != std::errc()) return text.size();
  return static_cast<std::size_t>(stop - text.data());
}

std::optional<double> ParseQuantity(std::string_view text, std::string_view unit) {
  text = WithoutBlanks(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  const std::size_t end = BeginOfUnit(text);
  const std::optional<double> value = NumberIn<double>(text.substr(0, end));
  const std::string_view symbol = WithoutBlanks(text.substr(end));
  if (!value || symbol.empty()) return value;
  const std::size_t slash = symbol.find('/');
  const std::size_t base_slash = unit.find('/');
  if (base_slash == std::string_view::npos) return InBaseOf(*value, symbol, unit);
  if (slash == std::string_view::npos) return std::nullopt;
  const auto over =
      InBaseOf(*value, WithoutBlanks(symbol.substr(0, slash)), unit.substr(0, base_slash));
  const auto under =
      InBaseOf(1.0, WithoutBlanks(symbol.substr(slash + 1)), unit.substr(base_slash + 1));
  if (!over || !under) return std::nullopt;
  return *over / *under;
}

}  // namespace mindahl
