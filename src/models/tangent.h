#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace mindahl::models {

/// A number with its derivatives in some directions, for arithmetic that takes them along.
template <std::size_t kDirections>
struct Tangent {
  double value = 0.0;
  std::array<double, kDirections> slope{};

  Tangent() = default;
  Tangent(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): a number

  /// Returns the number itself, which varies as one in a direction.
  [[nodiscard]] static Tangent Along(double at, std::size_t direction, double by = 1.0) {
    Tangent result(at);
    result.slope[direction] = by;
    return result;
  }

  /// Returns f(x), from f and f' at x.
  [[nodiscard]] Tangent Through(double function, double derivative) const {
    Tangent result(function);
    for (std::size_t k = 0; k < kDirections; ++k) result.slope[k] = derivative * slope[k];
    return result;
  }

  friend Tangent operator+(Tangent a, const Tangent& b) {
    a.value += b.value;
    for (std::size_t k = 0; k < kDirections; ++k) a.slope[k] += b.slope[k];
    return a;
  }
  friend Tangent operator-(Tangent a, const Tangent& b) {
    a.value -= b.value;
    for (std::size_t k = 0; k < kDirections; ++k) a.slope[k] -= b.slope[k];
    return a;
  }
  friend Tangent operator*(const Tangent& a, const Tangent& b) {
    Tangent result(a.value * b.value);
    for (std::size_t k = 0; k < kDirections; ++k) {
      result.slope[k] = a.value * b.slope[k] + b.value * a.slope[k];
    }
    return result;
  }
  friend Tangent operator*(double a, Tangent b) {
    b.value *= a;
    for (double& each : b.slope) each *= a;
    return b;
  }
  friend Tangent operator/(const Tangent& a, const Tangent& b) {
    Tangent result(a.value / b.value);
    for (std::size_t k = 0; k < kDirections; ++k) {
      result.slope[k] = (a.slope[k] - result.value * b.slope[k]) / b.value;
    }
    return result;
  }
};

/// Returns the number without its derivatives, which alone decides between cases.
inline double ValueOf(double x) { return x; }
template <std::size_t kDirections>
double ValueOf(const Tangent<kDirections>& x) {
  return x.value;
}

/// Returns x within ±limit; beyond it the limit, with the limit's derivatives.
template <typename Real>
Real Within(const Real& x, const Real& limit) {
  if (ValueOf(x) > ValueOf(limit)) return limit;
  if (ValueOf(x) < -ValueOf(limit)) return -1.0 * limit;
  return x;
}

}  // namespace mindahl::models
