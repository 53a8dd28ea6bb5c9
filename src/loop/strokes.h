#pragma once

#include <cstddef>
#include <memory_resource>
#include <span>
#include <utility>
#include <vector>

#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// Least fraction of the widest cycle's amplitude at which a cycle is one of the widest.
inline constexpr double kSteadyAmplitude = 0.95;

/// Returns the reversals, with the record's first and last sample where they lie at an extreme.
std::pmr::vector<std::size_t> TurningPoints(std::span<const double> displacement,
                                            std::span<const std::size_t> reversals,
                                            std::pmr::memory_resource* scratch);

/// Least and greatest mean over a twentieth of the stroke: what the force keeps to, not its noise.
std::pair<double, double> MovingMeanRange(std::span<const double> force);

/// Returns ∮ T dδ [J] from one turning point to the next but one, closed by a chord.
double CycleEnergy(const RecordView& record, std::size_t first, std::size_t last);

/// Returns a quarter of the travel [m] over three turning points.
inline double CycleAmplitude(std::span<const double> displacement,
                             std::span<const std::size_t> points) {
  const auto way = [&](std::size_t k) {
    const double difference = displacement[points[k + 1]] - displacement[points[k]];
    return difference < 0 ? -difference : difference;
  };
  return (way(0) + way(1)) / 4;
}

}  // namespace mindahl::loop
