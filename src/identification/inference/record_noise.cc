#include "identification/inference/record_noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/probability.h"
#include "identification/inference/noise.h"

namespace mindahl::identification {
namespace {

struct RecordVariance {
  double variance = 0.0;
  double degrees_of_freedom = 0.0;
};

std::size_t CountedSamplesOf(const ScaledRecord& record) {
  return record.counts.size() - static_cast<std::size_t>(std::ranges::count(record.counts, 0));
}

RecordVariance VarianceOf(const Problem& problem, std::size_t r, std::span<const double> residual) {
  const ScaledRecord& record = problem.data->records[r];
  const auto samples = static_cast<double>(CountedSamplesOf(record));
  double squares = 0.0;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (record.counts[i] != 0) squares += residual[i] * residual[i];
  }
  const std::array series = {residual};
  const std::array counts = {std::span<const unsigned char>(record.counts)};
  const double independent =
      samples / EstimateAutocorrelation(series, counts).SquaredCorrelations();
  const double parameters = ParametersOfRecord(problem, r);
  return {.variance = squares / std::max(samples - parameters, 1.0),
          .degrees_of_freedom = independent - parameters};
}

}  // namespace

double ParametersOfRecord(const Problem& problem, std::size_t r) {
  double own = 0.0;
  double shared = 0.0;
  for (const std::size_t p : problem.parameters.free()) {
    const Parameter& parameter = problem.parameters[p];
    if (parameter.term->scope == Scope::kContact) {
      ++shared;
    } else if (parameter.record == r) {
      ++own;
    }
  }
  const auto samples = static_cast<double>(CountedSamplesOf(problem.data->records[r]));
  return own + shared * samples / static_cast<double>(problem.data->counted);
}

double ChanceOfOneNoise(const Problem& problem, std::span<const double> residual) {
  constexpr double kFewest = 8.0;  // degrees of freedom: a variance that is known to one half
  const std::size_t records = problem.data->records.size();
  if (records < 2) return 1.0;
  double count = 0.0;
  double degrees = 0.0;
  double pooled = 0.0;
  double logarithms = 0.0;
  double reciprocals = 0.0;
  std::size_t begin = 0;
  for (std::size_t r = 0; r < records; ++r) {
    const std::size_t size = problem.data->records[r].size();
    const RecordVariance of = VarianceOf(problem, r, residual.subspan(begin, size));
    begin += size;
    if (of.degrees_of_freedom < kFewest) continue;
    ++count;
    degrees += of.degrees_of_freedom;
    pooled += of.degrees_of_freedom * of.variance;
    logarithms +=
        of.degrees_of_freedom * std::log(std::max(of.variance, kRoundingRms * kRoundingRms));
    reciprocals += 1 / of.degrees_of_freedom;
  }
  constexpr double kRounding = 10 * kRoundingRms;
  if (count < 2 || pooled < degrees * kRounding * kRounding) return 1.0;
  const double statistic = degrees * std::log(pooled / degrees) - logarithms;
  const double correction = 1 + (reciprocals - 1 / degrees) / (3 * (count - 1));
  return PValueOfChiSquared(statistic / correction, count - 1);
}

}  // namespace mindahl::identification
