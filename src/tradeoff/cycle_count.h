#pragma once

#include <span>
#include <vector>

namespace mindahl::tradeoff {

/// Returns the cycles passed at each sample of a drive from the unloaded contact: a quarter to the
/// first reversal, half a cycle from one to the next, in proportion to the displacement between.
std::vector<double> CyclesPassed(std::span<const double> displacement);

}  // namespace mindahl::tradeoff
