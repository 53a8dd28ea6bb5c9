#include "tradeoff/cycle_count.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mindahl/loop/reversals.h"

namespace mindahl::tradeoff {

std::vector<double> CyclesPassed(std::span<const double> displacement) {
  constexpr double kQuarter = 0.25;
  constexpr double kHalf = 0.5;
  std::vector<double> way = {0.0};  // the contact is unloaded there, wherever samples begin
  way.insert(way.end(), displacement.begin(), displacement.end());
  const std::vector<std::size_t> reversals = loop::FindReversals(way, 0.0);
  std::vector<double> extremes = {0.0};
  for (const std::size_t reversal : reversals) extremes.push_back(way[reversal]);
  // The last swing is not over: it is taken to be as long as the one before, or twice the first,
  // and without a reversal to end at the last sample.
  const double last = extremes.back();
  extremes.push_back(reversals.empty()       ? way.back()
                     : reversals.size() == 1 ? -last
                                             : extremes[extremes.size() - 2]);

  std::vector<double> cycles;
  cycles.reserve(displacement.size());
  std::size_t swing = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    while (swing < reversals.size() && reversals[swing] < i) ++swing;
    const double length = std::abs(extremes[swing + 1] - extremes[swing]);
    const double done = std::abs(way[i] - extremes[swing]);
    const double share = length > 0 ? std::min(done / length, 1.0) : 1.0;
    const double before = swing == 0 ? 0.0 : kQuarter + kHalf * static_cast<double>(swing - 1);
    cycles.push_back(before + (swing == 0 ? kQuarter : kHalf) * share);
  }
  return cycles;
}

}  // namespace mindahl::tradeoff
