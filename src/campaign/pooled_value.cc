#include "mindahl/campaign/pooled_value.h"

#include <algorithm>
#include <cmath>

#include "core/probability.h"
#include "mindahl/core/error.h"

namespace mindahl::campaign {

void PooledValue::Add(double value, double standard_error) {
  RequireFinite("value to be pooled", value);
  RequirePositive("standard error of a value to be pooled", standard_error);
  if (count_++ == 0) origin_ = value;
  const double weight = 1 / (standard_error * standard_error);
  const double off = value - origin_;
  weights_ += weight;
  squared_weights_ += weight * weight;
  values_ += weight * off;
  squares_ += weight * off * off;
}

double PooledValue::mean() const { return origin_ + values_ / weights_; }

double PooledValue::ChiSquared() const {
  return std::max(0.0, squares_ - values_ * values_ / weights_);
}

double PooledValue::scatter() const {
  if (count_ < 2) return 0.0;
  const double beyond = ChiSquared() - static_cast<double>(count_ - 1);
  return std::sqrt(std::max(0.0, beyond / (weights_ - squared_weights_ / weights_)));
}

double PooledValue::standard_error() const {
  const double between = scatter();
  return std::sqrt(1 / weights_ + between * between * squared_weights_ / (weights_ * weights_));
}

double PooledValue::p_value() const {
  if (count_ < 2) return 1.0;
  return PValueOfChiSquared(ChiSquared(), static_cast<double>(count_ - 1));
}

}  // namespace mindahl::campaign
