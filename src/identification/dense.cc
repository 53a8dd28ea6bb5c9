#include "identification/dense.h"

#include <Eigen/Dense>

namespace mindahl::identification {

Eigen::MatrixXd LeftOver(const MatrixView& a, const MatrixView& b) {
  if (a.cols() == 0) return b;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(a);
  // Eigen divides by the pivots of a matrix of zeros.
  if (factors.rank() == 0) return b;
  return b - a * factors.solve(b);
}

}  // namespace mindahl::identification
