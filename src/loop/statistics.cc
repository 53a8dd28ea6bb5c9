#include "loop/statistics.h"

#include <cmath>
#include <cstddef>
#include <vector>

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

double NoiseByDifferences(std::span<const double> values, std::size_t order,
                          std::pmr::memory_resource* scratch) {
  if (values.size() <= order) return 0.0;
  std::pmr::vector<double> differences(values.begin(), values.end(), scratch);
  double variance = 1.0;  // of a difference over the noise's
  for (std::size_t k = 1; k <= order; ++k) {
    for (std::size_t i = 0; i + k < values.size(); ++i)
      differences[i] = differences[i + 1] - differences[i];
    variance *= 2.0 * static_cast<double>(2 * k - 1) / static_cast<double>(k);
  }
  differences.resize(values.size() - order);
  for (double& difference : differences) difference = std::abs(difference);
  return kDeviationOverMedian * Median(differences) / std::sqrt(variance);
}

}  // namespace mindahl::loop
