#include "core/extremes.h"

#include <Eigen/Core>

namespace mindahl {
namespace {

/// Eigen compares several values at once, which compilers may not of a loop.
auto ArrayOf(std::span<const double> values) {
  return Eigen::Map<const Eigen::ArrayXd>(values.data(), std::ssize(values));
}

}  // namespace

Extremes ExtremesOf(std::span<const double> values) {
  return {ArrayOf(values).minCoeff(), ArrayOf(values).maxCoeff()};
}

bool AreAllWithin(std::span<const double> values, double largest) {
  // A NaN is the largest, and within nothing.
  return values.empty() || ArrayOf(values).abs().maxCoeff<Eigen::PropagateNaN>() <= largest;
}

}  // namespace mindahl
