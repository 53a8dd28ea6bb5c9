#include "io/column_name.h"

#include <algorithm>
#include <array>

#include "io/number_cell.h"
#include "mindahl/core/units.h"

namespace mindahl::io {

namespace {

constexpr std::size_t kLongestUnit = 8;  // bytes; "furlong" is a unit to refuse, not part of a name

bool IsKnownUnit(std::string_view symbol) {
  return LengthUnit(symbol) || AngleUnit(symbol) || ForceUnit(symbol) || TorqueUnit(symbol) ||
         TimeUnit(symbol);
}

bool IsUnitWord(std::string_view word) {
  return !word.empty() && word.size() <= kLongestUnit &&
         word.find_first_of(" \t_") == std::string_view::npos;
}

ColumnName Split(std::string_view header, std::size_t separator) {
  return {std::string(Trimmed(header.substr(0, separator))),
          std::string(Trimmed(header.substr(separator + 1)))};
}

}  // namespace

std::string_view WithoutBrackets(std::string_view cell) {
  cell = Trimmed(cell);
  const bool bracketed = cell.size() >= 2 && ((cell.front() == '[' && cell.back() == ']') ||
                                              (cell.front() == '(' && cell.back() == ')'));
  return bracketed ? Trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

bool LooksLikeUnit(std::string_view cell) {
  constexpr std::array<std::string_view, 22> kOtherUnits = {
      "-",  "%", "V", "mV", "A",   "mA",  "bar",  "Pa",   "kPa",  "MPa", "psi",
      "°C", "C", "K", "Hz", "kHz", "m/s", "mm/s", "um/s", "µm/s", "lb",  "rpm"};
  const std::string_view symbol = WithoutBrackets(cell);
  return symbol.size() != Trimmed(cell).size() || IsKnownUnit(symbol) ||
         std::ranges::find(kOtherUnits, symbol) != kOtherUnits.end();
}

ColumnName SplitColumnName(std::string_view header) {
  header = Trimmed(header);
  if (header.ends_with(']') || header.ends_with(')')) {
    const std::size_t open = header.rfind(header.back() == ']' ? '[' : '(');
    if (open != std::string_view::npos && open > 0) {
      return {std::string(Trimmed(header.substr(0, open))),
              std::string(WithoutBrackets(header.substr(open)))};
    }
  }
  for (const std::size_t separator : {header.rfind(','), header.find('/')}) {
    if (separator == std::string_view::npos || separator == 0) continue;
    ColumnName split = Split(header, separator);
    if (IsUnitWord(split.unit)) return split;
  }
  const std::size_t separator = header.find_last_of("_ ");
  if (separator != std::string_view::npos && separator > 0) {
    ColumnName split = Split(header, separator);
    // "F_rad" is a radial force.
    constexpr std::size_t kLongestSymbol = 2;
    const bool is_direction = split.unit == "rad" && split.name.size() <= kLongestSymbol;
    if (IsKnownUnit(split.unit) && !is_direction) return split;
  }
  return {std::string(header), ""};
}

}  // namespace mindahl::io
