#include "identification/inference/record_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "identification/inference/evidence.h"
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
  std::vector<RecordVariance> variances;
  double degrees = 0.0;
  double pooled = 0.0;
  std::size_t begin = 0;
  for (std::size_t r = 0; r < records; ++r) {
    const std::size_t size = problem.data->records[r].size();
    const RecordVariance of = VarianceOf(problem, r, residual.subspan(begin, size));
    begin += size;
    if (of.degrees_of_freedom < kFewest) continue;
    variances.push_back(of);
    degrees += of.degrees_of_freedom;
    pooled += of.degrees_of_freedom * of.variance;
  }
  constexpr double kRounding = 10 * kRoundingRms;
  if (variances.size() < 2 || pooled < degrees * kRounding * kRounding) return 1.0;
  pooled /= degrees;
  double statistic = 0.0;
  double reciprocals = -1 / degrees;
  for (const RecordVariance& of : variances) {
    const double variance = std::max(of.variance, kRoundingRms * kRoundingRms);
    statistic += of.degrees_of_freedom * std::log(pooled / variance);
    reciprocals += 1 / of.degrees_of_freedom;
  }
  const auto free = static_cast<double>(variances.size() - 1);
  return PValueOfChiSquared(statistic / (1 + reciprocals / (3 * free)), free);
}

}  // namespace mindahl::identification
