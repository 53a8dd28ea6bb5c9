#include "identification/dense.h"

#include <Eigen/Dense>
#include <algorithm>

namespace mindahl::identification {

Eigen::MatrixXd Product(const MatrixView& a, const MatrixView& b) { return a * b; }

Eigen::MatrixXd TransposedProduct(const MatrixView& a, const MatrixView& b) {
  return a.transpose() * b;
}

Eigen::MatrixXd SolveSymmetric(const MatrixView& a, const MatrixView& b) {
  return a.ldlt().solve(b);
}

Eigen::MatrixXd SolveLeastSquares(const MatrixView& a, const MatrixView& b, Eigen::Index* rank) {
  if (rank != nullptr) *rank = 0;
  if (a.cols() == 0) return Eigen::MatrixXd(0, b.cols());
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(a);
  if (rank != nullptr) *rank = factors.rank();
  // Eigen divides by the pivots of a matrix of zeros.
  if (factors.rank() == 0) return Eigen::MatrixXd::Zero(a.cols(), b.cols());
  return factors.solve(b);
}

Eigen::MatrixXd LeftOver(const MatrixView& a, const MatrixView& b) {
  return b - a * SolveLeastSquares(a, b);
}

Eigenpairs SymmetricEigenpairs(const MatrixView& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace mindahl::identification
