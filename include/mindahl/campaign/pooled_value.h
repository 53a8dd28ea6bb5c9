#pragma once

#include <cstddef>

namespace mindahl::campaign {

/// One value of a quantity that cycles have in common, from sums: in memory that their number does
/// not change. Of values yₖ with standard errors eₖ, wₖ = 1/eₖ²,
///   ȳ = Σwy/Σw,   Q = Σw(y − ȳ)²,   τ² = max(0, (Q − (n − 1))/(Σw − Σw²/Σw)),
///   e(ȳ)² = 1/Σw + τ²·Σw²/(Σw)²
/// τ the scatter between cycles beyond their errors (DerSimonian & Laird 1986, eq. 8).
class PooledValue {
 public:
  /// @param value           finite
  /// @param standard_error  > 0
  /// @throws InvalidArgument for what breaks these
  void Add(double value, double standard_error);

  [[nodiscard]] std::size_t count() const { return count_; }
  // Require at least one value:
  [[nodiscard]] double mean() const;
  [[nodiscard]] double scatter() const;         ///< τ
  [[nodiscard]] double standard_error() const;  ///< standard error of the mean, scatter included
  /// Returns P(χ²(n − 1) ≥ Q): the chance of such a scatter from the stated errors alone.
  [[nodiscard]] double p_value() const;

 private:
  [[nodiscard]] double ChiSquared() const;

  std::size_t count_ = 0;
  double origin_ = 0.0;  // the first value: sums of what is left lose no digits
  double weights_ = 0.0;
  double squared_weights_ = 0.0;
  double values_ = 0.0;
  double squares_ = 0.0;
};

}  // namespace mindahl::campaign
