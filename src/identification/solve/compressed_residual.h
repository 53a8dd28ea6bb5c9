#pragma once

#include <Eigen/Dense>
#include <span>

namespace mindahl::identification {

/// n residuals of P coordinates as P + 1 with the same sum of squares, the same JᵀJ and the same
/// Jᵀr: what a least-squares solver learns of them, at a cost that does not grow with n. The first
/// P rows are what the Jacobian's columns explain of the residual, the last is what they do not.
class CompressedResidual {
 public:
  CompressedResidual() = default;

  /// @param normal    JᵀJ, from which a rank below P shows as rows of zeros
  /// @param gradient  Jᵀr
  /// @param cost      rᵀr
  /// @param frozen    1 for a coordinate whose column counts as 0; empty: none
  CompressedResidual(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient, double cost,
                     std::span<const unsigned char> frozen);

  [[nodiscard]] const Eigen::VectorXd& residual() const { return residual_; }
  [[nodiscard]] const Eigen::MatrixXd& jacobian() const { return jacobian_; }
  /// Returns by how much a Gauss–Newton step lowers the linearised sum of squares.
  [[nodiscard]] double Explained() const {
    return residual_.head(residual_.size() - 1).squaredNorm();
  }

 private:
  Eigen::VectorXd residual_;
  Eigen::MatrixXd jacobian_;
};

}  // namespace mindahl::identification
