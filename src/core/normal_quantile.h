#pragma once

namespace mindahl {

/// Two-sided 95 % quantile of the standard normal distribution, Φ⁻¹(0.975).
inline constexpr double kNormalQuantile95 = 1.959963984540054;

/// Returns Φ⁻¹((1 + confidence)/2), within which a normal law lies with this probability.
double NormalQuantile(double confidence);

}  // namespace mindahl
