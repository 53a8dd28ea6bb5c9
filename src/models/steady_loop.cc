#include "mindahl/models/steady_loop.h"

#include <cmath>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "models/requirements.h"
#include "models/scaled_branches.h"

namespace mindahl::models {
namespace {

/// Makes a law in long double: a power of α multiplies the error of its logarithm by α.
BranchLaw Made(long double stiffness, double shape_exponent, long double slip_force) {
  const BranchLaw law = {.tangential_stiffness = static_cast<double>(stiffness),
                         .shape_exponent = shape_exponent,
                         .slip_force = static_cast<double>(slip_force)};
  Validate(law);
  return law;
}

}  // namespace

double SteadyPeakForce(const FrictionModel& model, const BranchLaw& law, double amplitude) {
  RequireLawAndAmplitude(law, amplitude);
  return law.slip_force * BranchScaling(model, law).Peak(amplitude).peak.force;
}

double SteadyLoopEnergy(const FrictionModel& model, const BranchLaw& law, double amplitude) {
  RequireLawAndAmplitude(law, amplitude);
  const auto y = backbone::Normalize(law.tangential_stiffness, amplitude, law.slip_force);
  const long double unit =
      static_cast<long double>(law.slip_force) * law.slip_force / law.tangential_stiffness;
  const double peak = BranchScaling(model, law).Peak(amplitude).peak.force;
  const BranchScale scale = model.scale(-peak, /*virgin=*/false);
  // A branch runs from −t* to t* = −t* + h·φ(2ky), so W = 2[∫ branch − 2y·t*] is a Masing loop's
  // energy in other units, (h/4k)·[8∫₀^{2ky} φ − 4·(2ky)·φ(2ky)]: one form, free of cancellation.
  const long double height = static_cast<long double>(scale.span) * scale.remaining;
  const long double rate =
      std::pow(static_cast<long double>(scale.remaining), law.shape_exponent - 1.0L) / scale.span;
  const long double stretch = 2 * rate;  // 1 for a Masing law
  return Representable(
      "energy per cycle [J]",
      unit * height / (2 * stretch) *
          backbone::MasingLoopEnergy({stretch * y.high, stretch * y.low}, law.shape_exponent));
}

double ContactAmplitude(const FrictionModel& model, const BranchLaw& law, const SeriesSpring& rig,
                        double amplitude) {
  RequireLawAndAmplitude(law, amplitude);
  Validate(rig);
  if (IsRigid(rig)) return amplitude;
  const double spring_travel = law.slip_force / rig.stiffness;
  const double rate = law.tangential_stiffness / law.slip_force;
  return BranchScaling(model, law, spring_travel).ContactAmplitude(rate * amplitude) / rate;
}

BranchLaw DahlEquivalent(const BranchLaw& masing, double amplitude) {
  RequireLawAndAmplitude(masing, amplitude);
  // 1 − T*/(2Tc) = (1 + u)/2 has the digits that T* → Tc would lose.
  const long double remaining = BackboneRemaining(masing, amplitude);
  return Made(masing.tangential_stiffness * std::pow((1 + remaining) / 2, masing.shape_exponent),
              masing.shape_exponent, masing.slip_force * (1 + remaining));
}

BranchLaw MasingEquivalent(const BranchLaw& dahl, double amplitude) {
  RequireLawAndAmplitude(dahl, amplitude);
  const long double peak = SteadyPeakForce(*FindFrictionModel("dahl"), dahl, amplitude);
  return Made(dahl.tangential_stiffness * std::pow(1 + peak / dahl.slip_force, dahl.shape_exponent),
              dahl.shape_exponent, (dahl.slip_force + peak) / 2);
}

}  // namespace mindahl::models
