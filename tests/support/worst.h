#pragma once

#include <cmath>
#include <string>

namespace mindahl::testing {

/// The largest of many errors, and where it was; a NaN is larger than any.
struct Worst {
  double value = 0.0;
  std::string where;

  template <typename Describe>
  void Add(double error, Describe describe) {
    if (error <= value || std::isnan(value)) return;
    value = error;
    where = describe();
  }
};

}  // namespace mindahl::testing
