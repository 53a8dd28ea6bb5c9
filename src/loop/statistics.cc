#include "loop/statistics.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace mindahl::loop {

double NoiseByDifferences(std::span<const double> values, std::size_t order) {
  if (values.size() <= order) return 0.0;
  std::vector<double> differences(values.begin(), values.end());
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
