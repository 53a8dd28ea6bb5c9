#pragma once

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <limits>

namespace mindahl {

/// Minimises a function on an interval: the best of some places, then the minimum next to it, to
/// half of a double's bits, which is as precise as a minimum's place can be.
template <typename Function>
double LeastOf(const Function& function, double low, double high, int places) {
  constexpr int kBits = 26;
  const double step = (high - low) / places;
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= places; ++i) {
    const double value = function(low + step * i);
    if (value < least) {
      least = value;
      best = i;
    }
  }
  const double from = std::max(low, low + step * (best - 1));
  const double to = std::min(high, low + step * (best + 1));
  const auto [place, value] = boost::math::tools::brent_find_minima(function, from, to, kBits);
  // It never asks for the ends themselves.
  if (function(from) <= value) return from;
  return function(to) <= value ? to : place;
}

}  // namespace mindahl
