#include "mindahl/report/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

namespace mindahl::report {

namespace {

struct Prefix {
  double factor;
  std::string_view name;
};

constexpr std::array<Prefix, 9> kPrefixes = {{
    {1e-15, "f"},
    {1e-12, "p"},
    {1e-9, "n"},
    {1e-6, "µ"},
    {1e-3, "m"},
    {1.0, ""},
    {1e3, "k"},
    {1e6, "M"},
    {1e9, "G"},
}};

/// A stiffness is read against a displacement: N/µm, not MN/m.
constexpr std::array<Prefix, 4> kStiffnesses = {{
    {1.0, "N/m"},
    {1e3, "N/mm"},
    {1e6, "N/µm"},
    {1e9, "N/nm"},
}};

constexpr std::array<std::string_view, 6> kPrefixed = {"N", "m", "J", "Pa", "s", "rad"};

const Prefix& Suiting(std::span<const Prefix> prefixes, double magnitude) {
  // A value that rounds to 1000 at four digits is shown as 1 of the next prefix.
  constexpr double kRoundsUp = 1 - 5e-5;
  const Prefix* suiting = &prefixes.front();
  for (const Prefix& prefix : prefixes) {
    if (magnitude >= kRoundsUp * prefix.factor) suiting = &prefix;
  }
  return *suiting;
}

}  // namespace

ScaledUnit UnitFor(std::string_view unit, double magnitude) {
  const double size = std::abs(magnitude);
  if (unit == "-") return {1.0, ""};
  if (!(size > 0) || !std::isfinite(size)) return {1.0, std::string(unit)};
  if (unit == "N/m") {
    const Prefix& suiting = Suiting(kStiffnesses, size);
    return {suiting.factor, std::string(suiting.name)};
  }
  // A prefix stands before a first letter that is a unit of one.
  const std::string_view first = unit.substr(0, unit.find_first_of(" /"));
  if (std::ranges::find(kPrefixed, first) == kPrefixed.end()) return {1.0, std::string(unit)};
  // Nobody reads kilometres or kiloradians.
  const bool is_length = unit == "m" || unit == "rad" || unit == "s";
  const Prefix& suiting =
      Suiting(std::span(kPrefixes).first(is_length ? 6 : kPrefixes.size()), size);
  return {suiting.factor, fmt::format("{}{}", suiting.name, unit)};
}

std::string WithUnit(std::string_view name, std::string_view unit) {
  return unit.empty() || unit == "-" ? std::string(name) : fmt::format("{} [{}]", name, unit);
}

void ScaleAxes(io::PlotPanel& panel, std::string_view x_name, std::string_view x_unit,
               std::string_view y_name, std::string_view y_unit) {
  double width = 0.0;
  double height = 0.0;
  for (const io::PlotSeries& series : panel.series) {
    for (const double x : series.x) width = std::max(width, std::abs(x));
    for (const double y : series.y) height = std::max(height, std::abs(y));
  }
  const ScaledUnit along = UnitFor(x_unit, width);
  const ScaledUnit upward = UnitFor(y_unit, height);
  for (io::PlotSeries& series : panel.series) {
    for (double& x : series.x) x /= along.factor;
    for (auto* values : {&series.y, &series.lower, &series.upper}) {
      for (double& y : *values) y /= upward.factor;
    }
  }
  panel.x_label = WithUnit(x_name, along.name);
  panel.y_label = WithUnit(y_name, upward.name);
}

std::string Quantity(double value, std::string_view unit, int digits) {
  const ScaledUnit scaled = UnitFor(unit, value);
  const double number = value / scaled.factor;
  // 120 of two digits is not 1.2e+02.
  constexpr double kThousand = 1000.0;
  const int places = std::abs(number) < 10          ? 1
                     : std::abs(number) < 100       ? 2
                     : std::abs(number) < kThousand ? 3
                                                    : digits;
  return fmt::format("{:.{}g}{}{}", number, std::max(digits, places),
                     scaled.name.empty() ? "" : " ", scaled.name);
}

std::string RoundedTo(double error, double value) {
  if (!(error > 0) || !std::isfinite(error)) return fmt::format("{:.6g}", value);
  // The second digit of the error as it is printed, so that 0.0996 is 0.10 and not 0.100.
  constexpr double kRoundsUp = 0.995;
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(error / kRoundsUp)));
  constexpr int kMostDecimals = 9;
  constexpr double kMostWritten = 1e6;    // beyond it zeros are counted
  constexpr double kLeastWritten = 1e-4;  // below it zeros are counted too
  if (decimals > kMostDecimals && std::abs(value) < kLeastWritten && value != 0) {
    constexpr int kMostDigits = 5;
    const int digits = static_cast<int>(std::floor(std::log10(std::abs(value)))) + decimals;
    return fmt::format("{:.{}e}", value, std::clamp(digits, 0, kMostDigits));
  }
  if (decimals > kMostDecimals) return fmt::format("{:.6g}", value);
  const double rounded =
      decimals < 0 ? std::round(value * std::pow(10.0, decimals)) / std::pow(10.0, decimals)
                   : value;
  if (std::abs(rounded) >= kMostWritten && decimals <= 0) {
    const int digits = static_cast<int>(std::floor(std::log10(std::abs(rounded)))) + decimals;
    return fmt::format("{:.{}e}", rounded, std::max(0, digits));
  }
  const std::string text = fmt::format("{:.{}f}", rounded, std::max(0, decimals));
  return text.find_first_not_of("-0.") == std::string::npos && text.starts_with('-')
             ? text.substr(1)
             : text;
}

namespace {

std::string Joined(const std::string& number, const ScaledUnit& unit) {
  return unit.name.empty() ? number : number + " " + unit.name;
}

}  // namespace

std::string QuantityWithError(double value, std::optional<double> error, std::string_view unit) {
  const double size = error.value_or(0.0);
  const ScaledUnit scaled = UnitFor(unit, std::max(std::abs(value), size));
  const double scaled_error = size / scaled.factor;
  std::string number = RoundedTo(scaled_error, value / scaled.factor);
  if (size > 0) number.append(" ± ").append(RoundedTo(scaled_error, scaled_error));
  return Joined(number, scaled);
}

std::string QuantityWithInterval(double value, std::optional<double> lower,
                                 std::optional<double> upper, std::string_view unit) {
  const ScaledUnit scaled = UnitFor(unit, value);
  if (!lower && !upper) return Quantity(value, unit);
  // Two digits of half the interval.
  const double half = (upper.value_or(value) - lower.value_or(value)) / (lower && upper ? 2 : 1);
  const auto rounded = [&](double end) {
    return RoundedTo(half / scaled.factor, end / scaled.factor);
  };
  const auto end = [&](const std::optional<double>& at) { return at ? rounded(*at) : "open"; };
  return fmt::format("{} ({} … {})", Joined(rounded(value), scaled), end(lower), end(upper));
}

std::string UnitIn(const Units& units, std::string_view unit) {
  if (units.force == kUnitsOfForce.force) return std::string(unit);
  std::string translated;
  for (std::size_t begin = 0; begin < unit.size();) {
    const std::size_t end = std::min(unit.find_first_of(" /()²", begin), unit.size());
    const std::string_view symbol = unit.substr(begin, end - begin);
    translated += symbol == "m" ? "rad" : symbol == "N" ? "N m" : symbol == "kg" ? "kg m²" : symbol;
    if (end < unit.size()) translated += unit[end];
    begin = end + 1;
  }
  // A product below the stroke needs brackets.
  const std::size_t below = std::min(translated.find('/'), translated.size());
  if (translated.find(' ', below) != std::string::npos &&
      translated.find('(') == std::string::npos) {
    translated.insert(below + 1, "(").append(")");
  }
  return translated;
}

}  // namespace mindahl::report
