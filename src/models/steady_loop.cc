#include "mindahl/models/steady_loop.h"

#include <cmath>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone_integrals.h"

namespace mindahl {
namespace {

void Require(const BranchLaw& law, double amplitude) {
  Validate(law);
  RequireNonNegative("amplitude [m]", amplitude);
}

}  // namespace

double SteadyPeakForce(const FrictionModel& model, const BranchLaw& law, double amplitude) {
  Require(law, amplitude);
  const double y = law.tangential_stiffness / law.slip_force * amplitude;
  return law.slip_force * model.steady_peak(y, law.shape_exponent).force;
}

double SteadyLoopEnergy(const FrictionModel& model, const BranchLaw& law, double amplitude) {
  Require(law, amplitude);
  const double y = law.tangential_stiffness / law.slip_force * amplitude;
  const double peak = model.steady_peak(y, law.shape_exponent).force;
  const BranchScale scale = model.scale(-peak, peak, /*virgin=*/false);
  // A branch runs from −t* to t* = −t* + h·φ(2ky), so W = 2[∫ branch − 2y·t*] is a Masing loop's
  // energy in other units, (h/4k)·[8∫₀^{2ky} φ − 4·(2ky)·φ(2ky)]: one form, free of cancellation.
  const double rate = std::pow(scale.remaining, law.shape_exponent - 1) / scale.span;
  const double height = scale.span * scale.remaining;
  const long double unit =
      static_cast<long double>(law.slip_force) * law.slip_force / law.tangential_stiffness;
  return static_cast<double>(unit * height / (4 * rate) *
                             backbone::MasingLoopEnergy(2 * rate * y, law.shape_exponent));
}

double GrossSlipEnergyRatio(double shape_exponent) {
  RequireNonNegative("shape exponent [-]", shape_exponent);
  return shape_exponent >= 1 ? 1.0 : shape_exponent / (2 - shape_exponent);
}

}  // namespace mindahl
