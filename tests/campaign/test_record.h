#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "mindahl/loop/record.h"
#include "support/histories.h"

/// Long records of known truth.
namespace mindahl::testing {

inline constexpr models::BranchLaw kCycleLaw{5e7, 1.0 / 3.0, 60.0};
inline constexpr double kCycleReach = 2.5e-6;  // 1.4 of gross slip
inline constexpr std::size_t kCycleSamples = 120;
inline constexpr double kCycleNoise = 0.5;  // [N]

/// Steady cycles, one fewer whole ones than are asked for: from a quarter before a lower turning
/// point to a quarter after the last. From each lower turning point on the slip force is that of
/// the law times the factor of the cycle; time in seconds, a sample a millisecond.
inline loop::Record TestRecord(
    std::size_t cycles, std::uint64_t seed = 1, double noise = kCycleNoise,
    const std::function<double(std::size_t)>& factor = [](std::size_t) { return 1.0; }) {
  Generator generator(seed);
  loop::Record record;
  History one(kCycleSamples);
  for (std::size_t i = 0; i < kCycleSamples; ++i) {
    const double phase =
        2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(kCycleSamples);
    one[i] = -kCycleReach * std::cos(phase);
  }
  for (std::size_t cycle = 0; cycle <= cycles; ++cycle) {
    models::BranchLaw law = kCycleLaw;
    law.slip_force *= factor(cycle);
    // Twice round from a virgin contact: the second is steady.
    History twice = one;
    twice.insert(twice.end(), one.begin(), one.end());
    const std::vector<double> force = Respond(Model("mindlin-dahl"), law, twice);
    const std::size_t first = cycle == 0 ? 3 * kCycleSamples / 4 : 0;
    const std::size_t end = cycle == cycles ? kCycleSamples / 4 : kCycleSamples;
    for (std::size_t i = first; i < end; ++i) {
      record.time.push_back(1e-3 * static_cast<double>(cycle * kCycleSamples + i));
      record.displacement.push_back(one[i]);
      record.force.push_back(force[kCycleSamples + i] + noise * Normal(generator));
    }
  }
  return record;
}

/// Lines as of a file with a header.
inline std::vector<std::size_t> LinesOf(const loop::Record& record) {
  std::vector<std::size_t> lines(record.size());
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i] = i + 2;
  return lines;
}

}  // namespace mindahl::testing
