#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace mindahl::campaign {

/// How far repeats of a test are from each other, beside what each says of its own error.
struct Repeats {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;  ///< between them
  double stated_error = 0.0;        ///< root of the mean square of their standard errors
  /// Of Σ((x − x̄)/e)² by χ², x̄ weighted: that the stated errors make such a scatter.
  double p_value = 1.0;

  /// Is the scatter more than the stated errors make, at a chance of one in a hundred?
  [[nodiscard]] bool exceed_errors() const { return p_value < 0.01; }
  /// "as the errors say, p 0.43".
  [[nodiscard]] std::string InWords() const;
};

/// @param values  of one quantity, one a test
/// @param errors  their standard errors, > 0
/// @returns nothing for fewer than two
/// @throws InvalidArgument where sizes differ
std::optional<Repeats> DescribeRepeats(std::span<const double> values,
                                       std::span<const double> errors);

}  // namespace mindahl::campaign
