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
  ReversalFinder finder(gate);
  for (const double x : displacement) {
    if (const std::optional<std::size_t> reversal = finder.Add(x)) reversals.push_back(*reversal);
  }
}

}  // namespace mindahl::loop
