#pragma once

namespace mindahl {

/// Half a normal law lies within this many standard deviations with 95 %: Φ⁻¹(0.975).
inline constexpr double kNormalQuantile95 = 1.959963984540054;

}  // namespace mindahl
