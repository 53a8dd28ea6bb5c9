#include "identification/dense.h"

#include <Eigen/Dense>
#include <algorithm>

namespace mindahl::identification {

Eigen::MatrixXd Product(const MatrixView& a, const MatrixView& b) { return a * b; }

Eigen::MatrixXd TransposedProduct(const MatrixView& a, const MatrixView& b) {
  return a.transpose() * b;
}

Eigen::MatrixXd SquareOf(const MatrixView& a) {
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(a.rows(), a.rows());
  square.selfadjointView<Eigen::Lower>().rankUpdate(a);
  square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
  return square;
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

Eigen::MatrixXd PseudoInverse(const MatrixView& a) {
  return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(a).pseudoInverse();
}

Eigen::MatrixXd UpperTriangle(const MatrixView& a) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> factors(a);
  Eigen::MatrixXd triangle = Eigen::MatrixXd::Zero(a.cols(), a.cols());
  const Eigen::Index rows = std::min(a.cols(), a.rows());
  triangle.topRows(rows) = factors.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  return triangle;
}

Eigen::MatrixXd InverseOfTriangle(const MatrixView& triangle) {
  return triangle.triangularView<Eigen::Upper>().solve(
      Eigen::MatrixXd::Identity(triangle.rows(), triangle.cols()));
}

Eigenpairs SymmetricEigenpairs(const MatrixView& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

RightSingular RightSingularVectors(const MatrixView& a) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace mindahl::identification
