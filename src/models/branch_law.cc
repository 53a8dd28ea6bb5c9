#include "mindahl/models/branch_law.h"

#include <cmath>
#include <limits>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/backbone_integrals.h"

namespace mindahl {

void Validate(const BranchLaw& law) {
  RequirePositive("tangential stiffness [N/m]", law.tangential_stiffness);
  RequirePositive("slip force [N]", law.slip_force);
  RequireNonNegative("shape exponent [-]", law.shape_exponent);
  if (law.shape_exponent > backbone::kLargestShapeExponent<double>) {
    ThrowInvalid("shape exponent [-]", law.shape_exponent, "must be <= 1e100");
  }
  const double inverse_elastic_limit = law.tangential_stiffness / law.slip_force;
  if (!std::isnormal(inverse_elastic_limit)) {
    ThrowInvalid("tangential stiffness over slip force [1/m]", inverse_elastic_limit,
                 "must be a normal double, about 2e-308 to 2e308");
  }
}

double GrossSlipDisplacement(const BranchLaw& law) {
  const double beta = 1 - law.shape_exponent;
  if (beta <= 0) return std::numeric_limits<double>::infinity();
  return law.slip_force / law.tangential_stiffness / beta;
}

namespace {

using Shape = backbone::GeneralShape<long double>;

long double Normalized(const BranchLaw& law, double x) {
  return static_cast<long double>(law.tangential_stiffness) / law.slip_force *
         std::abs(static_cast<long double>(x));
}

}  // namespace

double BackboneForce(const BranchLaw& law, double x) {
  const long double force = Shape{law.shape_exponent}.Force(Normalized(law, x));
  return std::copysign(static_cast<double>(law.slip_force * force), x);
}

double BackboneRemaining(const BranchLaw& law, double x) {
  return static_cast<double>(Shape{law.shape_exponent}.Remaining(Normalized(law, x)));
}

double BackboneSlope(const BranchLaw& law, double x) {
  return static_cast<double>(law.tangential_stiffness *
                             Shape{law.shape_exponent}.Slope(Normalized(law, x)));
}

double BackboneWork(const BranchLaw& law, double x) {
  const auto slip_force = static_cast<long double>(law.slip_force);
  return static_cast<double>(slip_force * slip_force / law.tangential_stiffness *
                             backbone::Work(Normalized(law, x), law.shape_exponent));
}

BackboneGradient DifferentiateBackbone(const BranchLaw& law, double x) {
  const auto phi = backbone::Differentiate<long double>(Normalized(law, x), law.shape_exponent);
  const long double scale = std::copysign(law.slip_force, x);
  return {static_cast<double>(scale * phi.elastic),
          static_cast<double>(scale * phi.shape_derivative),
          static_cast<double>(scale * (phi.force - phi.elastic))};
}

}  // namespace mindahl
