#include <algorithm>
#include <cmath>

#include "mindahl/core/error.h"
#include "mindahl/identification/adequacy.h"

namespace mindahl::identification {

ResidualStatistics DescribeResiduals(std::span<const std::span<const double>> residuals,
                                     std::span<const std::span<const double>> forces,
                                     double slip_force) {
  RequireSameSize("residual series", residuals.size(), "force series", forces.size());
  ResidualStatistics statistics;
  double sum_of_squares = 0.0;
  double sum_of_steps = 0.0;
  double force_sum = 0.0;
  for (std::size_t record = 0; record < residuals.size(); ++record) {
    const std::span<const double> r = residuals[record];
    RequireSameSize("residuals", r.size(), "forces", forces[record].size());
    statistics.samples += r.size();
    for (std::size_t i = 0; i < r.size(); ++i) {
      sum_of_squares += r[i] * r[i];
      if (i > 0) sum_of_steps += (r[i] - r[i - 1]) * (r[i] - r[i - 1]);
      statistics.max_abs = std::max(statistics.max_abs, std::abs(r[i]));
      force_sum += forces[record][i];
    }
  }
  if (statistics.samples == 0) throw InvalidArgument("no residuals: there must be samples");

  const auto count = static_cast<double>(statistics.samples);
  double force_variation = 0.0;
  for (const std::span<const double> force : forces) {
    for (const double value : force) {
      force_variation += (value - force_sum / count) * (value - force_sum / count);
    }
  }
  statistics.rms = std::sqrt(sum_of_squares / count);
  statistics.normalized_rms = statistics.rms / slip_force;
  statistics.r_squared = force_variation > 0 ? 1 - sum_of_squares / force_variation : 0.0;
  statistics.durbin_watson = sum_of_squares > 0 ? sum_of_steps / sum_of_squares : 2.0;
  return statistics;
}

}  // namespace mindahl::identification
