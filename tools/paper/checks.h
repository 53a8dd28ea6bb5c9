#pragma once

#include <string>
#include <vector>

/// The numbers of docs/paper.md and the errata of docs/theory.md §3, each found again from the
/// equations.
namespace mindahl::paper {

struct Check {
  std::string quantity;  ///< with its unit
  std::string expected;
  double value = 0.0;  ///< of `expected`
  double tolerance = 0.0;
  double found = 0.0;

  /// Within half a unit of the last digit of a number as it is printed, e.g. "0.93" or "4.839e8".
  static Check AsPrinted(std::string quantity, std::string expected, double found);
  static Check Within(std::string quantity, double value, double tolerance, double found);
  [[nodiscard]] bool Passes() const;
};

/// Largest |error| [% of T*] in each cycle of a model's response to a sine.
struct ErrorsByCycle {
  std::string model;
  std::string excitation;
  std::vector<double> worst;
};

/// The table of docs/paper.md: Dahl's models against Mindlin's under the sines of fig. 3.
std::vector<ErrorsByCycle> SineErrors();

/// Under the growing sine of fig. 7: what the paper compares, and what the envelope costs.
std::vector<ErrorsByCycle> GrowingSineErrors();

/// @param sine_errors     as from SineErrors
/// @param growing_errors  as from GrowingSineErrors
std::vector<Check> MakeChecks(const std::vector<ErrorsByCycle>& sine_errors,
                              const std::vector<ErrorsByCycle>& growing_errors);

}  // namespace mindahl::paper
