#pragma once

#include <Eigen/Core>
#include <vector>

namespace mindahl::identification {

/// Orthonormal combinations of some of C's columns, freed of J.
struct GramAxes {
  Eigen::MatrixXd vectors;      // by C's columns of unit norm, a column each
  Eigen::ArrayXd values;        // squares of their norms, before they were made one
  Eigen::ArrayXd coefficients;  // of the residuals
  Eigen::ArrayXd noise;  // variances of these by noise alone, over the noise's; no less than 1
};

/// A step from a fit to first order, in the units of the columns.
struct GramStep {
  Eigen::VectorXd law;         // δ
  Eigen::VectorXd omitted;     // γ
  Eigen::MatrixXd covariance;  // of δ, over the variance of the noise
};

/// Products AᵀA of the columns A = [J | C | r] of a fit: its Jacobian, columns that it lacks, and
/// its residuals. With r = −Jδ − Cγ + ε whatever is asked afterwards is algebra on matrices of some
/// forty rows, whatever the number of samples. A column that J spans is left out.
class Gram {
 public:
  /// @param law       J; a column of zeros is held
  /// @param omitted   C; all weighted, a row a sample
  /// @param own_part  least part of a column's norm that is orthogonal to J's columns, which do not
  ///                  span it then
  Gram(const Eigen::MatrixXd& law, const Eigen::MatrixXd& omitted, const Eigen::VectorXd& residual,
       double own_part);

  /// Takes the noise of the products, which is white otherwise.
  /// @param products  [J | C]ᵀΣ[J | C] with ε ~ N(0, s²Σ)
  void SetNoise(Eigen::MatrixXd products);

  /// Sum of squares of the residuals freed of J.
  [[nodiscard]] double sum_of_squares() const { return sum_of_squares_; }
  /// Noise variance that J absorbs, over that of one residual: tr[(JᵀJ)⁻¹JᵀΣJ].
  [[nodiscard]] double absorbed() const { return absorbed_; }
  /// Number of independent tests that a test of each of C's columns amounts to: (Σ√λ)²/Σλ of the
  /// eigenvalues λ of their correlations (Galwey 2009).
  [[nodiscard]] double IndependentTests() const;
  /// @param places  of some of C's columns
  [[nodiscard]] GramAxes AxesOf(const std::vector<Eigen::Index>& places) const;
  [[nodiscard]] GramAxes AxesOfAll() const;
  /// Returns the step to the least sum of squares of r + Jδ + Cγ.
  /// @param gains  of the axes: 1/value of least squares, less with a prior
  [[nodiscard]] GramStep StepBy(const GramAxes& axes, const Eigen::ArrayXd& gains) const;

 private:
  Eigen::VectorXd law_norms_;
  Eigen::VectorXd omitted_norms_;
  Eigen::MatrixXd inverse_of_law_;
  Eigen::MatrixXd shares_;  // of J's columns in each of C's
  Eigen::VectorXd law_residual_;
  Eigen::MatrixXd free_;  // CᵀC freed of J
  Eigen::VectorXd free_residual_;
  Eigen::MatrixXd law_noise_;   // covariance of δ by noise alone
  Eigen::MatrixXd free_noise_;  // CᵀΣC freed of J
  double sum_of_squares_;
  double absorbed_;
};

}  // namespace mindahl::identification
