#include "identification/inference/sampled_time.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace mindahl::identification {

Neighbours NeighboursOf(const ScaledRecord& record) {
  Neighbours neighbours;
  std::size_t next = 0;
  bool turned = false;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const bool turns = next < record.reversals.size() && record.reversals[next] == i;
    if (turns) ++next;
    if (!record.inserted.empty() && record.inserted[i] != 0) {
      turned = turns;
      if (turns && !neighbours.samples.empty()) neighbours.turns_after.back() = 1;
      continue;
    }
    neighbours.samples.push_back(i);
    neighbours.turned.push_back(turned ? 1 : 0);
    neighbours.turns_after.push_back(turns ? 1 : 0);
    turned = false;
  }
  return neighbours;
}

bool IsDisplacementHeld(const ScaledRecords& data, std::span<const Neighbours> neighbours) {
  constexpr double kOften = 0.2;  // of the samples: every fifth would be one
  std::size_t repeated = 0;
  std::size_t all = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const auto& samples = neighbours[r].samples;
    for (std::size_t k = 1; k < samples.size(); ++k, ++all) {
      const auto& displacement = data.records[r].displacement;
      if (displacement[samples[k]] == displacement[samples[k - 1]]) ++repeated;
    }
  }
  return static_cast<double>(repeated) > kOften * static_cast<double>(all);
}

Clock ClockOf(const ScaledRecords& data, std::span<const Neighbours> neighbours) {
  Clock clock;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const auto grows = [&](std::size_t one, std::size_t next) {
      return record.time[next] > record.time[one];
    };
    const auto& samples = neighbours[r].samples;
    clock.timed = clock.timed && !record.velocity.empty() &&
                  std::ranges::adjacent_find(samples, std::not_fn(grows)) == samples.end();
  }
  const double first = static_cast<double>(neighbours[0].samples.size()) - 1;
  clock.unit = clock.timed ? data.records[0].units.half_duration : std::max(first, 1.0) / 2;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    std::vector<double>& time = clock.time.emplace_back(record.size());
    const auto& samples = neighbours[r].samples;
    const double middle = (static_cast<double>(samples.size()) - 1) / 2;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const std::size_t i = samples[k];
      time[i] = clock.timed ? record.time[i] * record.units.half_duration / clock.unit
                            : (static_cast<double>(k) - middle) / clock.unit;
    }
  }
  return clock;
}

void Derive(std::span<const double> values, std::span<const double> time,
            const Neighbours& neighbours, bool within_strokes, std::span<double> rate) {
  const auto& samples = neighbours.samples;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const bool looks_back = k > 0 && !(within_strokes && neighbours.turned[k] != 0);
    const bool looks_on =
        k + 1 < samples.size() && !(within_strokes && neighbours.turns_after[k] != 0 && k > 0);
    const std::size_t before = samples[looks_back ? k - 1 : k];
    const std::size_t after = samples[looks_on ? k + 1 : k];
    const double step = time[after] - time[before];
    rate[samples[k]] = step > 0 ? (values[after] - values[before]) / step : 0.0;
  }
}

}  // namespace mindahl::identification
