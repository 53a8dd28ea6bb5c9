#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/linear_columns.h"

namespace mindahl::identification {

/// A residual that refuses a trial: ½ of its square is beyond any cost that is finite, and finite.
inline constexpr double kRefused = 1e150;

/// n residuals of P coordinates as P + 1 with the same sum of squares, the same JᵀJ and the same
/// Jᵀr: what a least-squares solver learns of them, at a cost that does not grow with n. The first
/// P rows are what the Jacobian's columns explain of the residual, the last is what they do not.
struct CompressedResidual {
  CompressedResidual() = default;

  /// @param normal    JᵀJ, from which a rank below P shows as rows of zeros
  /// @param gradient  Jᵀr
  /// @param cost      rᵀr
  /// @param frozen    1 for a coordinate whose column counts as 0; empty: none
  CompressedResidual(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient, double cost,
                     std::span<const unsigned char> frozen);

  /// Returns by how much a Gauss–Newton step lowers the linearised sum of squares.
  [[nodiscard]] double Explained() const {
    return residual.head(residual.size() - 1).squaredNorm();
  }

  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

/// A coordinate of the search: a parameter's θ, or where Tc is eliminated ln(σ/Tc) or ln(Tc/k).
struct SearchedParameter {
  std::size_t parameter;
  double lower;  // of the coordinate
  double upper;
  double LawPoint::*eliminated = nullptr;  // the coordinate of the law; null: θ itself
};

/// The residual of a problem after variable projection (Golub & Pereyra 2003): the scale of the
/// response and all linear parameters take their least-squares values at every point, and the
/// residual depends on the searched coordinates alone. Its Jacobian is Kaufman's: the derivatives
/// of the response, orthogonal to the eliminated columns.
///
/// Tc is eliminated where t is searched over σ/Tc (and Tc/k of a rig). Where the user holds or
/// bounds σ or k, or one of the three has a prior, these and Tc are searched instead. In a fit of
/// the displacement Tc is searched and its factor Tc/σ eliminated, unless the user holds or bounds
/// σ or gives it a prior. A bound on an eliminated factor clamps it. Linear parameters with a prior
/// are searched too; the residuals of priors are in the cost, not in residual().
class ProjectedResidual {
 public:
  /// @param problem   must outlive the use; its weights may change before the next Bind()
  /// @param response  bound to the problem here
  void Bind(const Problem& problem, Response& response);

  /// Moves a parameter that the problem holds, of those without a column of their own.
  void HoldAt(std::size_t parameter, double theta) {
    theta_[parameter] = theta;
    if (ShapesColumns(*problem_, parameter)) FactoriseColumns();
  }

  /// Lets all linear parameters go that were held at a bound.
  void ReleaseLinear();
  /// Holds the first linear parameter of θ that lies beyond its bounds at the bound it passed.
  /// @returns false where none does
  bool HoldPassed(std::span<double> theta);

  [[nodiscard]] std::span<const SearchedParameter> searched() const { return searched_; }
  [[nodiscard]] const Problem& problem() const { return *problem_; }
  /// θ of what is held, and at the last evaluation of what is searched and not eliminated.
  [[nodiscard]] std::span<const double> theta() const { return theta_; }

  /// Writes the coordinates at θ, moved into their bounds.
  void Load(std::span<const double> theta, std::span<double> u) const;
  /// Writes θ of what is searched or eliminated, at the point of the last evaluation.
  void Store(std::span<const double> u, std::span<double> theta) const;

  /// Returns the sum of the squared weighted residuals; infinity where they are not finite.
  double Evaluate(std::span<const double> u);
  /// The same, and forms the normal equations.
  double Linearise(std::span<const double> u);
  /// JᵀJ and Jᵀr of the last Linearise().
  [[nodiscard]] const Eigen::MatrixXd& normal() const { return normal_; }
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }

  /// Evaluates with the scale eliminated whatever is held, for looks at the plane of σ/Tc, or of a
  /// displacement of Tc, and α.
  /// @returns infinity where the regression has the wrong sign; else σ or Tc is written into θ
  double EvaluateFreely(const LawPoint& at, std::span<double> theta);

  /// True if Tc, or Tc/σ of a displacement, is eliminated.
  [[nodiscard]] bool scale_is_linear() const { return scale_is_linear_; }

 private:
  void ChooseSearched();
  void FactoriseColumns();
  /// True if the columns of linear parameters, or what is taken off, depend on the parameter.
  [[nodiscard]] bool MovesColumns(std::size_t parameter) const;
  [[nodiscard]] LawPoint PointOf(std::span<const double> u);
  [[nodiscard]] std::pair<double, double> BoundsOfScale(double log_rate) const;
  double Regress(double log_rate, bool is_free, double held_scale);
  void DifferentiateColumns();
  /// Returns the products of scale·response and what is measured with the linear columns.
  [[nodiscard]] Eigen::VectorXd LinearProducts() const {
    return measured_products_ - scale_ * response_products_;
  }
  [[nodiscard]] bool is_forced() const { return problem_->data->is_forced(); }

  const Problem* problem_ = nullptr;
  Response* response_ = nullptr;
  std::vector<SearchedParameter> searched_;
  std::vector<Dependence> dependences_;  // on these
  std::vector<unsigned char> held_;      // linear parameters held at a bound
  std::vector<double> theta_;            // θ at the last evaluation of what is not eliminated
  LinearColumns columns_;
  Eigen::VectorXd weight_;
  Eigen::VectorXd measured_;         // weighted, projected
  Eigen::VectorXd response_values_;  // t, weighted, projected
  Eigen::VectorXd measured_products_;
  Eigen::VectorXd response_products_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd derivatives_;  // of the residual by what is searched
  double scale_ = 0.0;           // of t: Tc, or Tc/σ of a displacement
  bool scale_is_free_ = false;   // not clamped to its bounds
  bool scale_is_linear_ = false;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd gradient_;
};

}  // namespace mindahl::identification
