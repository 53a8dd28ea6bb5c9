#include "identification/problem/one_channel.h"

#include <algorithm>
#include <numeric>

namespace mindahl::identification {

bool AreOneChannel(const ScaledRecords& data, std::size_t one, std::size_t other) {
  constexpr double kOwnPart = 0.1;
  return std::ranges::all_of(data.records, [&](const ScaledRecord& record) {
    const auto& x = record.covariates[one];
    const auto& y = record.covariates[other];
    const auto count = static_cast<double>(x.size());
    const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / count;
    const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / count;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      xx += (x[i] - mean_x) * (x[i] - mean_x);
      xy += (x[i] - mean_x) * (y[i] - mean_y);
      yy += (y[i] - mean_y) * (y[i] - mean_y);
    }
    return xy * xy >= (1 - kOwnPart * kOwnPart) * xx * yy;
  });
}

}  // namespace mindahl::identification
