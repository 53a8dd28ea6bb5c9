#pragma once

#include <optional>
#include <string>
#include <string_view>

// Numbers of tables and figures, whose unit is apart: by the units of mindahl/report/quantity.h.
namespace mindahl::report {

/// A unit with a prefix: "N/µm" is 10⁶ N/m.
struct PrefixedUnit {
  std::string unit;   ///< "" of a pure number
  double size = 1.0;  ///< in the unit without it
};

/// The prefix with which a number of that magnitude is from 1 to 1000, as far as there is one; a
/// unit that has no usual prefixes stays as it is.
/// @param unit  in SI, "-" for a pure number
PrefixedUnit PrefixFor(double magnitude, std::string_view unit);

/// "39.87 ± 0.12": the error with two digits, the value to the same place.
std::string ValueText(double value, std::optional<double> error, double unit_size);

/// "39.63 … 40.11"; "open" for an end that is.
std::string IntervalText(std::optional<double> lower, std::optional<double> upper,
                         double unit_size);

/// "39.87 N/µm", five digits at most.
std::string QuantityText(double value, std::string_view unit);

/// "39.87 ± 0.12 N/µm"; without an error five digits.
std::string QuantityText(double value, std::optional<double> error, std::string_view unit);

}  // namespace mindahl::report
