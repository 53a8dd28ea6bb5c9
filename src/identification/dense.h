#pragma once

#include <Eigen/Core>

namespace mindahl::identification {

// Products and factorisations of dense matrices by Eigen, compiled once: in every source that uses
// them they would take more of the time to compile than all the rest of it.

using MatrixView = Eigen::Ref<const Eigen::MatrixXd>;

/// Returns AB.
Eigen::MatrixXd Product(const MatrixView& a, const MatrixView& b);
/// Returns AᵀB.
Eigen::MatrixXd TransposedProduct(const MatrixView& a, const MatrixView& b);

/// Returns what the columns of A leave of B: B − A·argmin |B − AX|.
Eigen::MatrixXd LeftOver(const MatrixView& a, const MatrixView& b);

struct Eigenpairs {
  Eigen::VectorXd values;   ///< increasing
  Eigen::MatrixXd vectors;  ///< a column each
};
/// Returns the eigenvalues and eigenvectors of a symmetric matrix that is not empty.
Eigenpairs SymmetricEigenpairs(const MatrixView& a);

}  // namespace mindahl::identification
