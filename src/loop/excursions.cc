#include "loop/excursions.h"

#include <algorithm>
#include <cmath>

#include "loop/scratch.h"

namespace mindahl::loop {
namespace {

/// Returns the extremes, with the record's ends.
std::pmr::vector<std::size_t> LocalExtremes(std::span<const double> displacement,
                                            std::pmr::memory_resource* scratch) {
  std::pmr::vector<std::size_t> points(scratch);
  FindReversals(displacement, 0.0, points);
  if (displacement.empty()) return points;
  points.insert(points.begin(), 0);
  points.push_back(displacement.size() - 1);
  return points;
}

}  // namespace

std::pmr::vector<Excursion> FindExcursions(std::span<const double> displacement,
                                           std::pmr::memory_resource* scratch) {
  // Points that are still open are kept in front of those not yet visited.
  std::pmr::vector<std::size_t> points = LocalExtremes(displacement, scratch);
  std::pmr::vector<Excursion> excursions(scratch);
  excursions.reserve(points.size());
  std::size_t open = 0;
  const auto excursion = [&](std::size_t i, std::size_t reversals) {
    return Excursion{std::abs(displacement[points[i + 1]] - displacement[points[i]]), points[i],
                     points[i + 1], reversals};
  };
  for (const std::size_t point : points) {
    points[open++] = point;
    while (open >= 4) {
      const Excursion inner = excursion(open - 3, 2);
      if (inner.range > excursion(open - 4, 1).range ||
          inner.range > excursion(open - 2, 1).range) {
        break;
      }
      excursions.push_back(inner);
      points[open - 3] = points[open - 1];
      open -= 2;
    }
  }
  for (std::size_t i = 0; i + 1 < open; ++i) excursions.push_back(excursion(i, 1));
  std::ranges::sort(excursions, [](const Excursion& one, const Excursion& other) {
    return one.range != other.range ? one.range < other.range : one.first < other.first;
  });
  return excursions;
}

std::size_t CountReversals(std::span<const Excursion> excursions, double gate) {
  std::size_t ends = 0;
  for (const Excursion& excursion : excursions) {
    if (excursion.range > gate) ends += excursion.reversals;
  }
  return ends == 0 ? 0 : ends - 1;  // one stroke is left, with a reversal at neither end
}

}  // namespace mindahl::loop
