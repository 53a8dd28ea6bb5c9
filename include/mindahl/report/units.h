#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "mindahl/io/plot.h"

namespace mindahl::report {

/// Holds the units of a report: those of a force along the contact, or of a torque about it.
struct Units {
  std::string_view force = "N";
  std::string_view displacement = "m";
  std::string_view stiffness = "N/m";
  std::string_view response = "N";    ///< the channel that is fitted: of residuals
  std::string_view excitation = "m";  ///< the other one: of reversals
};

/// Returns the units of a record.
constexpr Units UnitsOf(bool is_torsional) {
  if (!is_torsional) return {};
  return {.force = "N m",
          .displacement = "rad",
          .stiffness = "N m/rad",
          .response = "N m",
          .excitation = "rad"};
}

/// Returns the unit that a quantity of a torque has where that of a force has `unit`: N is N m, m
/// is rad and kg is kg m², so "N/m²" is "N m/rad²". Energies are in J either way.
std::string UnitOfTorque(std::string_view unit);

/// A unit for reading: with the prefix that makes a number of 1 to 1000 of a magnitude.
struct ScaledUnit {
  double factor = 1.0;  ///< a number of these times it is one of the unit without prefix
  std::string name;     ///< empty of "-"

  /// Returns a number that is written already with the unit behind it.
  [[nodiscard]] std::string Behind(const std::string& number) const {
    return name.empty() ? number : number + " " + name;
  }
};

/// @param unit  one that the reports use, as "m", "N/m" or "N m"; of another the factor is 1
/// @param digits  of the number that is written
ScaledUnit UnitFor(std::string_view unit, double magnitude, int digits = 4);

/// Returns "sigma [N/µm]"; the name alone of a unit that is empty or "-".
std::string WithUnit(std::string_view name, std::string_view unit);

/// Names the axes of a panel of numbers in these units, and puts them into those that suit them.
void ScaleAxes(io::PlotPanel& panel, std::string_view x_name, std::string_view x_unit,
               std::string_view y_name, std::string_view y_unit);

/// Returns "48.1 N/µm" of 4.814e7 N/m: significant digits, in the unit that suits it.
std::string Quantity(double value, std::string_view unit, int digits = 5);

/// Rounds a number to the decimals that give its error two digits: "48.142" of 0.0391; to five
/// digits where that would count zeros, "5.0016e+16".
/// @param error  > 0; where it is not, or not finite, the number has six digits
std::string RoundedTo(double error, double value);

/// Returns "48.142 ± 0.039 N/µm", no error where it is zero or there is none.
std::string QuantityWithError(double value, std::optional<double> error, std::string_view unit);

/// Returns "48.14 N/µm (48.07 … 48.22)"; "open" for an end that there is not, no brackets without
/// both. Without a value the limit alone, "> 12 N" or "< 12 N"; "" without that too.
std::string QuantityWithInterval(std::optional<double> value, std::optional<double> lower,
                                 std::optional<double> upper, std::string_view unit);

}  // namespace mindahl::report
