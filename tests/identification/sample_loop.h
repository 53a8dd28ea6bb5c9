#pragma once

#include "recovery/recovered.h"

/// The noise-free record on which options and reports are tested.
namespace mindahl::testing {

inline constexpr models::BranchLaw kLaw{5e7, 0.4, 60.0};
inline constexpr double kReach = 2.5e-6;  // 1.25 of gross slip

inline loop::Record Loop(double cycles = 2.0) {
  const History displacement = Cycling(Wave::kSine, kReach, cycles, 120);
  return testing::LoopOf(kLaw, displacement);
}

/// With noise of 1 % of Tc.
inline loop::Record NoisyLoop(std::uint64_t seed, double cycles = 2.0) {
  Generator generator(seed);
  return WithForceNoise(Loop(cycles), 0.01 * kLaw.slip_force, generator);
}

}  // namespace mindahl::testing
