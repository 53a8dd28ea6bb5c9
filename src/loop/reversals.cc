#include "mindahl/loop/reversals.h"

#include <algorithm>

#include "loop/scratch.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {
std::vector<std::size_t> FindReversals(std::span<const double> displacement, double gate) {
  std::pmr::vector<std::size_t> reversals;
  FindReversals(displacement, gate, reversals);
  return {reversals.begin(), reversals.end()};
}

void FindReversals(std::span<const double> displacement, double gate,
                   std::pmr::vector<std::size_t>& reversals) {
  RequireNonNegative("reversal gate [m]", gate);
  reversals.clear();
  if (displacement.empty()) return;

  std::size_t highest = 0;
  std::size_t lowest = 0;
  int direction = 0;  // unknown until the displacement has left the gate
  for (std::size_t i = 1; i < displacement.size(); ++i) {
    if (direction >= 0 && displacement[i] > displacement[highest]) highest = i;
    if (direction <= 0 && displacement[i] < displacement[lowest]) lowest = i;
    if (direction >= 0 && displacement[highest] - displacement[i] > gate) {
      if (direction > 0) reversals.push_back(highest);
      direction = -1;
      lowest = i;
    } else if (direction <= 0 && displacement[i] - displacement[lowest] > gate) {
      if (direction < 0) reversals.push_back(lowest);
      direction = 1;
      highest = i;
    }
  }
}

}  // namespace mindahl::loop
