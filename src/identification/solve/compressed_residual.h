#pragma once

#include <Eigen/Dense>
#include <span>

namespace mindahl::identification {

/// A residual that refuses a trial: ½ of its square is beyond any cost that is finite, and finite.
inline constexpr double kRefused = 1e150;

/// n residuals of P coordinates as P + 1 with the same sum of squares, the same JᵀJ and the same
/// Jᵀr: what a least-squares solver learns of them, at a cost that does not grow with n. The first
/// P rows are what the Jacobian's columns explain of the residual, the last is what they do not.
/// @tparam P  number of coordinates; Eigen::Dynamic: any
template <int P>
class CompressedResidual {
 public:
  static constexpr int kRows = P == Eigen::Dynamic ? Eigen::Dynamic : P + 1;
  using Residual = Eigen::Matrix<double, kRows, 1>;
  using Jacobian = Eigen::Matrix<double, kRows, P>;

  CompressedResidual() = default;

  /// @param normal    JᵀJ, from which a rank below P shows as rows of zeros
  /// @param gradient  Jᵀr
  /// @param cost      rᵀr
  /// @param frozen    1 for a coordinate whose column counts as 0; empty: none
  CompressedResidual(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient, double cost,
                     std::span<const unsigned char> frozen);

  [[nodiscard]] const Residual& residual() const { return residual_; }
  [[nodiscard]] const Jacobian& jacobian() const { return jacobian_; }
  /// Returns by how much a Gauss–Newton step lowers the linearised sum of squares.
  [[nodiscard]] double Explained() const {
    return residual_.head(residual_.size() - 1).squaredNorm();
  }

 private:
  Residual residual_;
  Jacobian jacobian_;
};

// Those that a search in small matrices of a known size is made for (tiny_search.cc), and any.
extern template class CompressedResidual<1>;
extern template class CompressedResidual<2>;
extern template class CompressedResidual<3>;
extern template class CompressedResidual<Eigen::Dynamic>;

}  // namespace mindahl::identification
