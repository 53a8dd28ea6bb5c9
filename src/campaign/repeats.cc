#include "mindahl/campaign/repeats.h"

#include <fmt/format.h>

#include <cmath>

#include "core/probability.h"
#include "mindahl/core/error.h"

namespace mindahl::campaign {

std::string Repeats::InWords() const {
  if (!p_value) return "no error is stated";
  return exceed_errors() ? fmt::format("more than the errors, p {:.1g}", *p_value)
                         : fmt::format("as the errors say, p {:.2g}", *p_value);
}

std::optional<Repeats> DescribeRepeats(std::span<const double> values,
                                       std::span<const double> errors) {
  if (!errors.empty()) RequireSameSize("values", values.size(), "errors", errors.size());
  if (values.size() < 2) return std::nullopt;
  const auto count = static_cast<double>(values.size());
  Repeats repeats{.count = values.size()};
  for (const double value : values) repeats.mean += value / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - repeats.mean) * (value - repeats.mean);
  repeats.standard_deviation = std::sqrt(squares / (count - 1));
  if (errors.empty()) return repeats;
  double mean_square = 0.0;
  double weights = 0.0;
  double weighted = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    mean_square += errors[k] * errors[k] / count;
    weights += 1 / (errors[k] * errors[k]);
    weighted += values[k] / (errors[k] * errors[k]);
  }
  repeats.stated_error = std::sqrt(mean_square);
  double chi_squared = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double off = (values[k] - weighted / weights) / errors[k];
    chi_squared += off * off;
  }
  repeats.p_value = PValueOfChiSquared(chi_squared, count - 1);
  return repeats;
}

}  // namespace mindahl::campaign
