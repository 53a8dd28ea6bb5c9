#pragma once

#include <cstddef>

namespace mindahl::loop {

/// Sets the limits within which a normal load is a series of constant ones.
struct LoadStepRules {
  /// [of the load] Largest deviation of a constant load, which a fit hardly sees.
  double constant = 0.01;
  /// [standard deviations of the readings' white noise] The same by noise: of 10⁵ readings the
  /// widest is 4.4 off.
  double noise = 5.0;
  /// [of the smaller] Least difference of loads with a step between; a smaller one may be a drift.
  double step = 0.05;
  /// [of the step next to it] Largest range of a constant load: the top of a wave is not flat.
  double flat = 0.1;
  /// [of the samples] Least fraction under a constant load: a wave is at its tops for less.
  double share = 0.6;
  /// [turning points] After the second, from which a piece begins, a constant load has a cycle.
  std::size_t turns = 4;
};

}  // namespace mindahl::loop
