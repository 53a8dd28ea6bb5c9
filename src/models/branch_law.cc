#include "mindahl/models/branch_law.h"

#include <cmath>
#include <limits>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"

namespace mindahl::models {

void Validate(const BranchLaw& law) {
  RequirePositive("tangential stiffness [N/m]", law.tangential_stiffness);
  RequirePositive("slip force [N]", law.slip_force);
  RequireNonNegative("shape exponent [-]", law.shape_exponent);
  // On a path of at most 1e100 m no σx/Tc overflows, nor that of a branch 2^α times as steep.
  constexpr double kLargestShapeExponent = 100.0;
  constexpr double kLargestRate = 1e150;
  if (law.shape_exponent > kLargestShapeExponent) {
    ThrowInvalid("shape exponent [-]", law.shape_exponent, "must be <= 100");
  }
  const double inverse_elastic_limit = law.tangential_stiffness / law.slip_force;
  if (!(inverse_elastic_limit >= 1 / kLargestRate && inverse_elastic_limit <= kLargestRate)) {
    ThrowInvalid("tangential stiffness over slip force [1/m]", inverse_elastic_limit,
                 "must lie within 1e-150 and 1e150");
  }
}

BranchLaw AtLoad(const BranchLaw& law, double load_ratio, double load_exponent) {
  return {.tangential_stiffness = law.tangential_stiffness * std::pow(load_ratio, load_exponent),
          .shape_exponent = law.shape_exponent,
          .slip_force = law.slip_force * load_ratio};
}

double GrossSlipDisplacement(const BranchLaw& law) {
  using Limits = std::numeric_limits<double>;
  const long double beta = 1.0L - law.shape_exponent;
  if (beta <= 0) return Limits::infinity();
  const long double displacement = law.slip_force / (law.tangential_stiffness * beta);
  return displacement <= Limits::max() ? static_cast<double>(displacement) : Limits::infinity();
}

namespace {

using ExtendedShape = backbone::GeneralShape<long double>;

/// At infinity every law has slipped.
backbone::Reduced<long double> ReducedAt(const BranchLaw& law, double x) {
  if (std::isnan(x)) ThrowInvalid("displacement [m]", x, "must be a number");
  if (std::isinf(x)) return {.y = 1, .w = 1, .z = 0};
  return backbone::Reduce(backbone::Normalize(law.tangential_stiffness, x, law.slip_force),
                          law.shape_exponent);
}

}  // namespace

double BackboneForce(const BranchLaw& law, double x) {
  const long double force = ExtendedShape{law.shape_exponent}.Force(ReducedAt(law, x));
  return std::copysign(static_cast<double>(law.slip_force * force), x);
}

double BackboneRemaining(const BranchLaw& law, double x) {
  return static_cast<double>(ExtendedShape{law.shape_exponent}.Remaining(ReducedAt(law, x)));
}

}  // namespace mindahl::models
