#include "identification/dense.h"

#include <Eigen/Dense>
#include <algorithm>

namespace mindahl::identification {

Eigen::MatrixXd Product(const MatrixView& a, const MatrixView& b) { return a * b; }

Eigen::MatrixXd TransposedProduct(const MatrixView& a, const MatrixView& b) {
  return a.transpose() * b;
}

Eigen::MatrixXd LeftOver(const MatrixView& a, const MatrixView& b) {
  if (a.cols() == 0) return b;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(a);
  // Eigen divides by the pivots of a matrix of zeros.
  if (factors.rank() == 0) return b;
  return b - a * factors.solve(b);
}

Eigenpairs SymmetricEigenpairs(const MatrixView& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace mindahl::identification
