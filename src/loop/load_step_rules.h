#pragma once

#include <cstddef>

namespace mindahl::loop {

/// What makes a normal load a series of constant ones.
struct LoadStepRules {
  /// [of the load] It is constant within so much to either side, which a fit hardly sees.
  double constant = 0.01;
  /// [standard deviations of the readings' white noise] Or within the noise: of 10⁵ readings the
  /// widest is 4.4 off.
  double noise = 5.0;
  /// [of the smaller] Loads with a step between them differ by more: what is less may be a drift.
  double step = 0.05;
  /// [of the step beside it] A constant load varies by less: the top of a wave is not flat.
  double flat = 0.1;
  /// [of the samples] So many are under a constant load: a wave is at its tops for less.
  double share = 0.6;
  /// [turning points] After the second, from which a piece begins, a constant load has a cycle.
  std::size_t turns = 4;
};

}  // namespace mindahl::loop
