#include "mindahl/report/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <utility>

namespace mindahl::report {

namespace {

/// Symbols for factors of 1000, the sixth for 1. A stiffness is read against a displacement, which
/// takes the prefix: N/µm, not MN/m.
constexpr std::array<std::string_view, 9> kPrefixes = {"f", "p", "n", "µ", "m", "", "k", "M", "G"};
constexpr std::array<std::string_view, 4> kStiffnesses = {"N/m", "N/mm", "N/µm", "N/nm"};
constexpr int kNoPrefix = 5;

constexpr std::array<std::string_view, 6> kPrefixed = {"N", "m", "J", "Pa", "s", "rad"};

}  // namespace

ScaledUnit UnitFor(std::string_view unit, double magnitude, int digits) {
  const double size = std::abs(magnitude);
  if (unit == "-") return {1.0, ""};
  if (!(size > 0) || !std::isfinite(size)) return {1.0, std::string(unit)};
  // A value that rounds to 1000 is shown as 1 of the next prefix.
  const double rounds_up = 1 - 0.5 * std::pow(10.0, -digits);
  const int thousands = static_cast<int>(std::floor(std::log10(size / rounds_up) / 3));
  const auto factor = [](int power) { return std::pow(10.0, 3 * power); };
  if (unit == "N/m") {
    const int power = std::clamp(thousands, 0, 3);
    return {factor(power), std::string(kStiffnesses.at(static_cast<std::size_t>(power)))};
  }
  // A prefix stands before a first letter that is a unit of one.
  const std::string_view first = unit.substr(0, unit.find_first_of(" /"));
  if (std::ranges::find(kPrefixed, first) == kPrefixed.end()) return {1.0, std::string(unit)};
  // Nobody reads kilometres or kiloradians.
  const bool is_length = unit == "m" || unit == "rad" || unit == "s";
  const int power = std::clamp(thousands, -kNoPrefix, is_length ? 0 : 3);
  const int place = power + kNoPrefix;
  return {factor(power), fmt::format("{}{}", kPrefixes.at(static_cast<std::size_t>(place)), unit)};
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
    for (double& y : series.y) y /= upward.factor;
  }
  panel.x_label = WithUnit(x_name, along.name);
  panel.y_label = WithUnit(y_name, upward.name);
}

std::string Quantity(double value, std::string_view unit, int digits) {
  constexpr int kLeast = 3;
  const ScaledUnit scaled = UnitFor(unit, value, std::max(digits, kLeast));
  const double number = value / scaled.factor;
  // 120 of two digits is not 1.2e+02, nor is 99.6.
  const double size = std::abs(number);
  const int places = size < 9.5 ? 1 : size < 99.5 ? 2 : size < 1000 ? kLeast : digits;
  return scaled.Behind(fmt::format("{:.{}g}", number, std::max(digits, places)));
}

std::string RoundedTo(double error, double value) {
  if (!(error > 0) || !std::isfinite(error)) return fmt::format("{:.6g}", value);
  // The second digit of the error as it is printed, so that 0.0996 is 0.10 and not 0.100.
  constexpr double kRoundsUp = 0.995;
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(error / kRoundsUp)));
  const double scale = std::pow(10.0, std::min(decimals, 0));
  const double rounded = decimals < 0 ? std::round(value * scale) / scale : value;
  constexpr int kMostDecimals = 9;  // beyond, zeros are counted
  if (std::abs(decimals) > kMostDecimals) return fmt::format("{:.5g}", value);
  std::string text = fmt::format("{:.{}f}", rounded, std::max(0, decimals));
  if (text.find_first_not_of("-0.") == std::string::npos) text.erase(0, text.find('0'));
  return text;
}

std::string QuantityWithError(double value, std::optional<double> error, std::string_view unit) {
  const double size = error.value_or(0.0);
  const ScaledUnit scaled = UnitFor(unit, std::max(std::abs(value), size));
  const double scaled_error = size / scaled.factor;
  std::string number = RoundedTo(scaled_error, value / scaled.factor);
  if (size > 0) number.append(" ± ").append(RoundedTo(scaled_error, scaled_error));
  return scaled.Behind(number);
}

std::string QuantityWithInterval(std::optional<double> value, std::optional<double> lower,
                                 std::optional<double> upper, std::string_view unit) {
  constexpr int kDigitsOfLimit = 4;
  if (!value && lower) return "> " + Quantity(*lower, unit, kDigitsOfLimit);
  if (!value && upper) return "< " + Quantity(*upper, unit, kDigitsOfLimit);
  if (!value) return "";
  if (!lower && !upper) return Quantity(*value, unit);
  // Two digits of half the interval.
  const double half = (upper.value_or(*value) - lower.value_or(*value)) / (lower && upper ? 2 : 1);
  const ScaledUnit scaled = UnitFor(unit, std::max(std::abs(*value), half));
  const auto rounded = [&](double end) {
    return RoundedTo(half / scaled.factor, end / scaled.factor);
  };
  const auto end = [&](const std::optional<double>& at) { return at ? rounded(*at) : "open"; };
  return fmt::format("{} ({} … {})", scaled.Behind(rounded(*value)), end(lower), end(upper));
}

std::string UnitOfTorque(std::string_view unit) {
  std::string translated(unit);
  for (const auto& [word, of_torque] :
       {std::pair("\\bm\\b", "rad"), {"\\bN\\b", "N m"}, {"\\bkg\\b", "kg m²"}}) {
    translated = std::regex_replace(translated, std::regex(word), of_torque);
  }
  return translated;
}

}  // namespace mindahl::report
