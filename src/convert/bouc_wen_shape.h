#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace mindahl::convert {

/// Bouc's and Wen's law in normalised form, dt/dy = 1 − |t|ⁿ(γ + β·sgn(t·ẏ)) with y = kx/Tc, t =
/// T/Tc, β + γ = 1. It has no closed form: the integrals
///   y = ∫₀ᵗ dz/(1 − c·zⁿ),   c = 1 against the motion's limit, c = γ − β on the way back to zero
/// are tabled once over t = 1 − e^{−q²}, which is smooth at either end, and read off by Hermite's
/// cubics.
class BoucWenShape {
 public:
  /// @param exponent  n, in 1 … 20
  /// @param beta      β, in (0, 1]
  BoucWenShape(double exponent, double beta);

  /// Rising branch of a steady loop.
  struct Loop {
    double peak = 0.0;  ///< t*
    double back = 0.0;  ///< way from −t* to 0
  };
  /// Returns the loop between ±y.
  [[nodiscard]] Loop LoopOf(double y) const;
  /// Returns t at a distance from the branch's start, in 0 … 2y.
  [[nodiscard]] double Rising(const Loop& loop, double distance) const;
  /// Returns W·k/Tc² of the loop between ±y.
  [[nodiscard]] double Energy(double y) const;

 private:
  enum Column : std::size_t {
    kLoading,    // ∫ dz/(1 − zⁿ)
    kUnloading,  // ∫ dz/(1 − (γ − β)zⁿ)
    kWay,        // their sum
    kLost,       // ∫ z·[1/(1 − zⁿ) − 1/(1 − (γ − β)zⁿ)] dz
    kColumns,
  };
  using Row = std::array<double, kColumns>;
  struct Node {
    double q = 0.0;
    Row integral{};
    Row slope{};  // by q
  };

  [[nodiscard]] Row SlopesAt(double q) const;
  [[nodiscard]] Row Integrate(double from, double to) const;
  [[nodiscard]] double Interpolate(std::size_t interval, double q, Column column) const;
  [[nodiscard]] double At(double q, Column column) const;
  [[nodiscard]] double Solve(double target, Column column) const;

  double exponent_;
  double back_;  // γ − β
  std::vector<Node> nodes_;
};

}  // namespace mindahl::convert
