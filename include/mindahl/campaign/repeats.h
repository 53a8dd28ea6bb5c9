#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace mindahl::campaign {

/// Compares the scatter of repeats of a test with their stated errors.
struct Repeats {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;  ///< between them
  /// Root of the mean square of their standard errors; empty where they state none.
  std::optional<double> stated_error = {};
  /// P(χ²(n − 1) ≥ Σ((x − x̄)/e)²), x̄ weighted: chance of such a scatter from the stated errors.
  std::optional<double> p_value = {};

  /// True if the stated errors make such a scatter with a chance below one in a hundred.
  [[nodiscard]] bool exceed_errors() const { return p_value && *p_value < 0.01; }
  /// Returns "as the errors say, p 0.43", or "no error is stated".
  [[nodiscard]] std::string InWords() const;
};

/// @param values  of one quantity, one a test
/// @param errors  their standard errors, > 0; none where they state none
/// @returns nothing for fewer than two
/// @throws InvalidArgument where sizes differ
std::optional<Repeats> DescribeRepeats(std::span<const double> values,
                                       std::span<const double> errors);

}  // namespace mindahl::campaign
