#include "report/prefixed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mindahl/report/quantity.h"

namespace mindahl::report {
namespace {

constexpr int kDigits = 5;  // of a number without an error
constexpr int kMostDecimals = 9;

/// Decimals with which a number of that size shows `digits` of its digits.
int Decimals(double size, int digits) {
  if (!(size > 0) || !std::isfinite(size)) return 0;
  const int leading = static_cast<int>(std::floor(std::log10(size) + 1e-12));
  return std::clamp(digits - 1 - leading, 0, kMostDecimals);
}

bool IsWritable(double number) {
  const double size = std::abs(number);
  return number == 0 || (size >= 1e-4 && size < 1e7);
}

std::string Signed(std::string text) { return text.starts_with('-') ? "−" + text.substr(1) : text; }

std::string Digits(double number) {
  return Signed(IsWritable(number) ? fmt::format("{:.{}g}", number, kDigits)
                                   : fmt::format("{:.{}e}", number, kDigits - 1));
}

std::string Joined(const std::string& number, std::string_view unit) {
  return unit.empty() ? number : fmt::format("{} {}", number, unit);
}

}  // namespace

PrefixedUnit PrefixFor(double magnitude, std::string_view unit) {
  const ScaledUnit scaled = UnitFor(unit, std::abs(magnitude));
  return {.unit = scaled.name, .size = scaled.factor};
}

std::string ValueText(double value, std::optional<double> error, double unit_size) {
  const double scaled = value / unit_size;
  if (!error || !(*error > 0) || !std::isfinite(*error)) return Digits(scaled);
  const double scaled_error = *error / unit_size;
  constexpr double kLeastPlain = 1e-6;
  const bool is_plain = IsWritable(scaled) && scaled_error >= kLeastPlain && scaled_error < 1e7;
  if (!is_plain || scaled_error < 1e-6 * std::abs(scaled)) {
    return fmt::format("{} ± {:.2g}", Signed(fmt::format("{:.9g}", scaled)), scaled_error);
  }
  const int decimals = Decimals(scaled_error, 2);
  return fmt::format("{} ± {:.{}f}", Signed(fmt::format("{:.{}f}", scaled, decimals)), scaled_error,
                     decimals);
}

std::string IntervalText(std::optional<double> lower, std::optional<double> upper,
                         double unit_size) {
  int decimals = -1;
  if (lower && upper && *upper > *lower) {
    const double width = (*upper - *lower) / unit_size;
    const double largest = std::max(std::abs(*lower), std::abs(*upper)) / unit_size;
    if (IsWritable(largest) && width > 1e-7 * largest) decimals = Decimals(width, 3);
  }
  const auto end = [&](const std::optional<double>& value) {
    if (!value) return std::string("open");
    return decimals < 0 ? Digits(*value / unit_size)
                        : Signed(fmt::format("{:.{}f}", *value / unit_size, decimals));
  };
  return fmt::format("{} … {}", end(lower), end(upper));
}

std::string QuantityText(double value, std::string_view unit) {
  const PrefixedUnit prefixed = PrefixFor(value, unit);
  return Joined(Digits(value / prefixed.size), prefixed.unit);
}

std::string QuantityText(double value, std::optional<double> error, std::string_view unit) {
  const PrefixedUnit prefixed = PrefixFor(std::max(std::abs(value), error.value_or(0.0)), unit);
  return Joined(ValueText(value, error, prefixed.size), prefixed.unit);
}

}  // namespace mindahl::report
