#include "identification/scaled_records.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "mindahl/core/error.h"

namespace mindahl::identification {

using loop::Record;

namespace {

struct Range {
  double middle;
  double half;
};

Range RangeOf(std::span<const double> values) {
  const auto [lowest, highest] = std::ranges::minmax(values);
  const double half = highest / 2 - lowest / 2;
  return {lowest + half, half};
}

/// Squares, products and ratios of displacements and forces must neither overflow nor vanish.
void RequireScale(std::string_view quantity, double half_range) {
  constexpr double kSmallest = 1e-100;
  constexpr double kLargest = 1e100;
  if (half_range < kSmallest || half_range > kLargest) {
    ThrowInvalid(quantity, half_range, "must lie between 1e-100 and 1e100: choose other units");
  }
}

}  // namespace

std::size_t ScaledRecords::samples() const {
  std::size_t count = 0;
  for (const ScaledRecord& record : records) count += record.displacement.size();
  return count;
}

std::size_t ScaledRecords::weighted_samples() const {
  std::size_t count = 0;
  for (const ScaledRecord& record : records) {
    count += static_cast<std::size_t>(
        std::ranges::count_if(record.root_weight, [](double weight) { return weight > 0; }));
  }
  return count;
}

std::vector<std::vector<double>> SplitByRecord(const ScaledRecords& data,
                                               std::span<const double> values) {
  std::vector<std::vector<double>> parts;
  std::size_t begin = 0;
  for (const ScaledRecord& record : data.records) {
    const auto part = values.subspan(begin, record.force.size());
    parts.emplace_back(part.begin(), part.end());
    begin += part.size();
  }
  return parts;
}

ScaledRecords Scale(std::span<const Record> records,
                    std::span<const std::vector<std::size_t>> reversals, int sense) {
  ScaledRecords scaled;
  scaled.sense = sense;
  scaled.length = 0.0;
  scaled.force = 0.0;
  for (const Record& record : records) {
    scaled.length = std::max(scaled.length, RangeOf(record.displacement).half);
    scaled.force = std::max(scaled.force, RangeOf(record.force).half);
  }
  if (!(scaled.length > 0)) {
    throw InvalidArgument("the displacement never changes: a fit needs a moving contact");
  }
  if (!(scaled.force > 0)) {
    throw InvalidArgument("the force never changes: a fit needs a loaded contact");
  }
  RequireScale("half range of the displacement [m]", scaled.length);
  RequireScale("half range of the force [N]", scaled.force);
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Record& record = records[r];
    ScaledRecord& target = scaled.records.emplace_back();
    target.reversals = reversals[r];
    target.displacement_reference = RangeOf(record.displacement).middle;
    target.force_reference = sense * RangeOf(record.force).middle;
    const std::size_t size = record.size();
    target.root_weight.assign(size, 1.0);
    const double first = record.time.empty() ? 0.0 : record.time.front();
    const double last = record.time.empty() ? static_cast<double>(size - 1) : record.time.back();
    target.half_duration = last > first ? (last - first) / 2 : 1.0;
    for (std::size_t i = 0; i < size; ++i) {
      const double time = record.time.empty() ? static_cast<double>(i) : record.time[i];
      target.displacement.push_back((record.displacement[i] - target.displacement_reference) /
                                    scaled.length);
      target.force.push_back((sense * record.force[i] - target.force_reference) / scaled.force);
      target.time.push_back((time - first) / target.half_duration - 1);
    }
  }
  return scaled;
}

}  // namespace mindahl::identification
