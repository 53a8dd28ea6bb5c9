#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace mindahl::loop {

/// A pair of neighbouring extremes that is left when all smaller ones are taken out: under a gate
/// of its range or more it makes no reversal.
struct Excursion {
  double range = 0.0;     // [m]
  std::size_t first = 0;  // samples of its two extremes
  std::size_t last = 0;
  std::size_t reversals = 0;  // that vanish with it: 2, or 1 where an end of the record is in it

  [[nodiscard]] std::size_t duration() const { return last - first; }
};

/// Returns the excursions of a displacement, by range. Closed inner loops by the four-point rule
/// (ASTM E1049 describes an equivalent one), the record's ends being extremes; what is left widens
/// up to the widest and then narrows, and goes one reversal at a time, from its ends. Cost: n, and
/// m log m for m extremes.
std::vector<Excursion> FindExcursions(std::span<const double> displacement);

}  // namespace mindahl::loop
