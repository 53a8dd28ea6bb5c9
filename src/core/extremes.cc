#include "core/extremes.h"

#include <Eigen/Core>

namespace mindahl {

Extremes ExtremesOf(std::span<const double> values) {
  // Eigen compares several values at once, which compilers may not of a loop.
  const Eigen::Map<const Eigen::ArrayXd> array(values.data(), std::ssize(values));
  return {array.minCoeff(), array.maxCoeff()};
}

}  // namespace mindahl
