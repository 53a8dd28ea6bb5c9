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

}  // namespace mindahl::testing
