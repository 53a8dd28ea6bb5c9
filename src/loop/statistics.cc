#include "loop/statistics.h"

#include <cmath>
#include <cstddef>

namespace mindahl::loop {

Line LineThrough(std::span<const double> numbers, std::span<const double> values) {
  const double centre = Mean(numbers);
  Line line{.mean = Mean(values), .degrees_of_freedom = static_cast<double>(values.size() - 2)};
  double squares = 0.0;
  double products = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += (numbers[i] - centre) * (numbers[i] - centre);
    products += (numbers[i] - centre) * (values[i] - line.mean);
  }
  line.slope = products / squares;
  double rest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double fitted = line.mean + line.slope * (numbers[i] - centre);
    rest += (values[i] - fitted) * (values[i] - fitted);
  }
  line.deviation = std::sqrt(rest / line.degrees_of_freedom);
  line.slope_error = std::sqrt(rest / line.degrees_of_freedom / squares);
  return line;
}

}  // namespace mindahl::loop
