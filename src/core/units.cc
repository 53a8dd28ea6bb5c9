#include "mindahl/core/units.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <numbers>

#include "core/text.h"

namespace mindahl {
namespace {

struct Entry {
  Unit unit;
  /// Other ways to write it, each between blanks; in lower case they count in any.
  std::string_view words = {};
};

using enum Dimension;
const std::array kUnits = {
    Entry{{"m", kLength, 1, 1}, " meter meters metre metres м "},
    Entry{{"mm", kLength, 1, 1e3},
          " MM ㎜ millimeter millimeters millimetre millimetres millimètres milímetros 毫米 мм "
          "1e-3m 10^-3m 10⁻³m "},
    Entry{{"um", kLength, 1, 1e6},
          " um ㎛ micron microns micrometer micrometers micrometre micrometres mikrometer 微米 мкм "
          "1e-6m 10^-6m 10⁻⁶m "},
    Entry{{"nm", kLength, 1, 1e9}, " ㎚ nanometer nanometers "},
    Entry{{"cm", kLength, 1, 1e2}, " ㎝ "},
    Entry{{"in", kLength, 254, 1e4}, " inch inches \" "},
    Entry{{"ft", kLength, 3048, 1e4}, " feet "},
    Entry{{"mil", kLength, 254, 1e7}, " mils thou "},
    Entry{{"pm", kLength, 1, 1e12}},
    // A mass that stands for a force is its weight.
    Entry{{"N", kForce, 1, 1}, " newton newtons 牛 牛顿 Н "},
    Entry{{"mN", kForce, 1, 1e3}, " millinewton millinewtons millin 1e-3N 10^-3N 10⁻³N "},
    Entry{{"uN", kForce, 1, 1e6}, " 1e-6N 10^-6N 10⁻⁶N "},
    Entry{{"kN", kForce, 1e3, 1}, " KN kilonewton kilonewtons 千牛 千牛顿 кН 1e3N 10^3N 10³N "},
    Entry{{"MN", kForce, 1e6, 1}},
    Entry{{"lbf", kForce, 4.4482216152605, 1}, " lb lbs pound pounds "},
    Entry{{"kgf", kForce, 9.80665, 1}, " kg ㎏ ㎏f kp кгс "},
    Entry{{"kip", kForce, 4448.2216152605, 1}, " kips "},
    Entry{{"gf", kForce, 9.80665, 1e3}, " g gram grams gramm "},
    Entry{{"daN", kForce, 10, 1}},
    Entry{{"dyn", kForce, 1, 1e5}, " dyne dynes "},
    Entry{{"ozf", kForce, 4.4482216152605, 16}, " oz "},
    Entry{{"cN", kForce, 1, 1e2}},
    Entry{{"rad", kAngle, 1, 1}, " radian radians "},
    Entry{{"mrad", kAngle, 1, 1e3}, " 1e-3rad 10^-3rad 10⁻³rad "},
    Entry{{"deg", kAngle, std::numbers::pi, 180}, " ° degree degrees 度 "},
    Entry{{"rev", kAngle, 2 * std::numbers::pi, 1}, " revolutions "},
    Entry{{"N m", kTorque, 1, 1}},
    Entry{{"N mm", kTorque, 1, 1e3}},
    Entry{{"s", kTime, 1, 1}, " sec secs second seconds sek seg 秒 с "},
    Entry{{"ms", kTime, 1, 1e3}, " msec 毫秒 milliseconds millis 1e-3s 10^-3s 10⁻³s "},
    Entry{{"us", kTime, 1, 1e6}, " usec micros 1e-6s 10^-6s 10⁻⁶s "},
    Entry{{"ns", kTime, 1, 1e9}, " nsec nanos "},
    Entry{{"min", kTime, 60, 1}, " minute minutes "},
    Entry{{"h", kTime, 3600, 1}, " hour hours hr "},
    Entry{{"Pa", kPressure, 1, 1}},
    Entry{{"hPa", kPressure, 1e2, 1}},
    Entry{{"kPa", kPressure, 1e3, 1}},
    Entry{{"MPa", kPressure, 1e6, 1}},
    Entry{{"GPa", kPressure, 1e9, 1}},
    Entry{{"mbar", kPressure, 1e2, 1}},
    Entry{{"bar", kPressure, 1e5, 1}},
    Entry{{"psi", kPressure, 6894.757293168, 1}},
    Entry{{"kgf/cm2", kPressure, 98066.5, 1}, " kgf/cm² "},
};

/// Finds the torque that two units make, a force by a length: "N·m", "Nm", "kgf.cm", "ft-lb".
std::optional<Unit> FindProduct(std::string_view symbol) {
  constexpr std::size_t kLongest = 12;
  if (symbol.size() > kLongest) return std::nullopt;
  for (const std::string_view sign : {" ", "·", "⋅", "*", "-", ".", ""}) {
    // Without a sign only behind newtons; "in lb" may be pounds.
    const std::size_t at = sign.empty() ? symbol.find('N') + 1 : symbol.find(sign);
    if (at == 0 || at >= symbol.size()) continue;
    std::optional<Unit> force = FindUnit(symbol.substr(0, at));
    std::optional<Unit> length = FindUnit(Trimmed(symbol.substr(at + sign.size())));
    if (!force || !length) continue;
    if (sign != " " && force->dimension == kLength) std::swap(force, length);
    if (force->dimension != kForce || length->dimension != kLength) continue;
    return Unit{force->symbol + " " + length->symbol, kTorque, force->numerator * length->numerator,
                force->denominator * length->denominator};
  }
  return std::nullopt;
}

/// Returns a value in a unit's base from one in `symbol`; empty where that is of another kind.
std::optional<double> InBaseOf(double value, std::string_view symbol, std::string_view base) {
  const std::optional<Unit> base_unit = FindUnit(base);
  const std::optional<Unit> unit = FindUnit(symbol);
  if (base_unit && unit && unit->dimension == base_unit->dimension) return unit->ToSi(value);
  const bool is_base = !base_unit && symbol == base && base != "-";
  return is_base ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<Unit> FindUnit(std::string_view symbol) {
  if (symbol.empty()) return std::nullopt;
  std::string ascii(symbol);
  for (const std::string_view micro : {"\u00b5", "\u03bc"}) {
    if (ascii.starts_with(micro)) ascii.replace(0, micro.size(), "u");
  }
  std::string word = ascii;  // "10^-6 m" and "µ m" in one
  std::erase(word, ' ');
  word = " " + word + " ";
  const std::string lower = LowerCase(word);
  const auto is_it = [&](const Entry& entry) {
    // A single letter, or two, differ by their case: g and G, mN and MN.
    return entry.unit.symbol == ascii || entry.words.find(word) != word.npos ||
           (symbol.size() >= 3 && entry.words.find(lower) != word.npos);
  };
  const auto* const entry = std::ranges::find_if(kUnits, is_it);
  return entry == kUnits.end() ? FindProduct(ascii) : entry->unit;
}

std::string UnitSymbols(Dimension dimension) {
  std::string symbols;
  for (const auto& [unit, words] : kUnits) {
    if (unit.dimension == dimension) symbols += (symbols.empty() ? "" : ", ") + unit.symbol;
  }
  return symbols;
}

std::size_t BeginOfUnit(std::string_view text) {
  double value = 0.0;
  std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
  if (begin < text.size() && text[begin] == '+') ++begin;
  const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + text.size(), value);
  if (error != std::errc()) return text.size();
  return static_cast<std::size_t>(stop - text.data());
}

std::optional<double> ParseQuantity(std::string_view text, std::string_view unit) {
  text = Trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  const std::size_t end = BeginOfUnit(text);
  const std::optional<double> value = NumberIn<double>(text.substr(0, end));
  const std::string_view symbol = Trimmed(text.substr(end));
  if (!value || symbol.empty()) return value;
  if (symbol == "%" && unit == "-") return *value / 100;
  const std::vector<std::string_view> base = PartsOf(unit, '/');
  if (base.size() == 1) return InBaseOf(*value, symbol, unit);
  const std::size_t slash = symbol.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto over = InBaseOf(*value, Trimmed(symbol.substr(0, slash)), base[0]);
  const auto under = InBaseOf(1.0, Trimmed(symbol.substr(slash + 1)), base[1]);
  if (!over || !under) return std::nullopt;
  return *over / *under;
}

}  // namespace mindahl
