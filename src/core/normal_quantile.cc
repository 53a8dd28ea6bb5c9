#include "core/normal_quantile.h"

#include <boost/math/special_functions/erf.hpp>
#include <numbers>

namespace mindahl {

double NormalQuantile(double confidence) {
  return std::numbers::sqrt2 * boost::math::erf_inv(confidence);
}

}  // namespace mindahl
