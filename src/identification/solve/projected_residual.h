#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "identification/problem/problem.h"

namespace mindahl::identification {

/// The residual of a problem after variable projection (Golub & Pereyra 2003): linear parameters
/// take their least-squares values at every point, and the residual depends on the others alone.
/// Its Jacobian is Kaufman's: the derivatives of the response, orthogonal to the columns that are
/// eliminated, of which Eigen's QR makes a basis. Linear parameters that the user bounds, and those
/// with a prior, are searched too; the residuals of priors are in the cost alone.
class ProjectedResidual {
 public:
  /// @param problem  must outlive this; neither it nor the weights of its samples may change
  explicit ProjectedResidual(const Problem& problem);

  /// Positions of what is searched among the parameters.
  [[nodiscard]] std::span<const std::size_t> searched() const { return searched_; }
  [[nodiscard]] const Parameter& Searched(Eigen::Index j) const {
    return problem_.parameters[searched_[static_cast<std::size_t>(j)]];
  }
  /// Returns what is searched of θ, moved into its bounds.
  [[nodiscard]] Eigen::VectorXd SearchedOf(std::span<const double> theta) const;
  [[nodiscard]] const Problem& problem() const { return problem_; }

  /// Returns the sum of the squared weighted residuals; infinity where they are not finite.
  double Evaluate(const Eigen::VectorXd& u);
  /// The same, and forms the normal equations.
  double Linearise(const Eigen::VectorXd& u);
  /// JᵀJ and Jᵀr of the last Linearise().
  [[nodiscard]] const Eigen::MatrixXd& normal() const { return normal_; }
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  /// Returns θ of all parameters at the last evaluation.
  [[nodiscard]] std::vector<double> Theta() const;

  /// Evaluates at θ with the factor of t eliminated too, Tc, or the σ of a displacement: that of θ
  /// is used in the ratios σ/Tc and Tc/k alone, unless it is held.
  /// @returns infinity where the regression has the wrong sign; else the factor and the linear
  ///   parameters are written into θ
  double EvaluateFreely(std::span<double> theta);

 private:
  void MoveTo(const Eigen::VectorXd& u);
  void FactoriseColumns();
  Eigen::VectorXd ProjectOut(Eigen::Ref<Eigen::VectorXd> column) const;
  void SolveLinear(std::span<double> theta) const;
  double Regress(std::span<const double> theta);
  double ScaleTo(std::span<const double> theta);

  const Problem& problem_;
  Response response_;
  std::vector<std::size_t> searched_;
  std::vector<double> theta_;  // of what is not eliminated
  std::vector<std::size_t> eliminated_;
  std::vector<std::size_t> linear_;  // of these, those whose columns are independent
  Eigen::VectorXd weight_;
  Eigen::MatrixXd basis_;     // of the weighted columns
  Eigen::MatrixXd triangle_;  // R of these
  Eigen::VectorXd measured_;  // weighted, projected
  Eigen::VectorXd measured_products_;
  Eigen::VectorXd response_values_;  // t, weighted, projected
  Eigen::VectorXd response_products_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd derivatives_;  // of the residual by what is searched
  double scale_ = 0.0;           // of t: Tc, or Tc/σ of a displacement
  Eigen::MatrixXd normal_;
  Eigen::VectorXd gradient_;
};

}  // namespace mindahl::identification
