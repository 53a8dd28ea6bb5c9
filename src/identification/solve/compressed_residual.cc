#include "identification/solve/compressed_residual.h"

#include <algorithm>
#include <cmath>

namespace mindahl::identification {

// JᵀJ of unit columns = PᵀLDLᵀP; the rows are √D·Lᵀ·P, and those of the residual √D⁻¹·L⁻¹·P·Jᵀr.
template <int P>
CompressedResidual<P>::CompressedResidual(const Eigen::MatrixXd& normal,
                                          const Eigen::VectorXd& gradient, double cost,
                                          std::span<const unsigned char> frozen) {
  // Pivots of unit columns below it are rounding: the direction has no effect.
  constexpr double kNoEffect = 1e-15;
  using Square = Eigen::Matrix<double, P, P>;
  using Vector = Eigen::Matrix<double, P, 1>;
  const Eigen::Index count = gradient.size();
  Vector norms(count);
  Vector slopes = gradient;
  Square correlation = normal;
  for (Eigen::Index j = 0; j < count; ++j) {
    const bool is_frozen = !frozen.empty() && frozen[static_cast<std::size_t>(j)] != 0;
    norms[j] = !is_frozen && normal(j, j) > 0 ? std::sqrt(normal(j, j)) : 0.0;
    const double inverse = norms[j] > 0 ? 1 / norms[j] : 0.0;
    slopes[j] *= inverse;
    correlation.row(j) *= inverse;
    correlation.col(j) *= inverse;
  }
  const Eigen::LDLT<Square> factors(correlation);
  const Vector pivots = factors.vectorD();
  Vector explained = factors.transpositionsP() * slopes;
  factors.matrixL().solveInPlace(explained);
  // P from the left: what Eigen's transpositions do from the right is Pᵀ.
  Square permuted = norms.asDiagonal();
  permuted = factors.transpositionsP() * permuted;
  jacobian_.setZero(count + 1, count);
  jacobian_.topRows(count) = factors.matrixU() * permuted;
  residual_.setZero(count + 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double root = pivots[k] > kNoEffect ? std::sqrt(pivots[k]) : 0.0;
    jacobian_.row(k) *= root;
    residual_[k] = root > 0 ? explained[k] / root : 0.0;
  }
  residual_[count] = std::sqrt(std::max(cost - residual_.squaredNorm(), 0.0));
}

template class CompressedResidual<1>;
template class CompressedResidual<2>;
template class CompressedResidual<3>;
template class CompressedResidual<Eigen::Dynamic>;

}  // namespace mindahl::identification
