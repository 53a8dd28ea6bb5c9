#include "mindahl/models/equivalent_law.h"

#include <cmath>

#include "mindahl/core/error.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/steady_loop.h"
#include "models/law_and_amplitude.h"

namespace mindahl::models {
namespace {

/// Makes a law in long double: a power of α multiplies the error of its logarithm by α.
BranchLaw Made(long double stiffness, double shape_exponent, long double slip_force) {
  const BranchLaw law{.tangential_stiffness = static_cast<double>(stiffness),
                      .shape_exponent = shape_exponent,
                      .slip_force = static_cast<double>(slip_force)};
  Validate(law);
  return law;
}

}  // namespace

BranchLaw DahlEquivalent(const BranchLaw& masing, double amplitude) {
  RequireLawAndAmplitude(masing, amplitude);
  // 1 − T*/(2Tc) = (1 + u)/2 has the digits that T* → Tc would lose.
  const long double remaining = BackboneRemaining(masing, amplitude);
  return Made(masing.tangential_stiffness *
                  std::pow((1 + remaining) / 2, static_cast<long double>(masing.shape_exponent)),
              masing.shape_exponent, masing.slip_force * (1 + remaining));
}

BranchLaw MasingEquivalent(const BranchLaw& dahl, double amplitude) {
  RequireLawAndAmplitude(dahl, amplitude);
  const long double peak = SteadyPeakForce(*FindFrictionModel("dahl"), dahl, amplitude);
  return Made(dahl.tangential_stiffness * std::pow(1 + peak / dahl.slip_force,
                                                   static_cast<long double>(dahl.shape_exponent)),
              dahl.shape_exponent, (dahl.slip_force + peak) / 2);
}

}  // namespace mindahl::models
