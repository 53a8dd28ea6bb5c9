#include "truth.h"

#include <cmath>

namespace mindahl::reliability {
namespace {

constexpr double kMindlin = 1.0 / 3;

double DrawShape(Draws& draws) {
  switch (draws.Index(10)) {
    case 0:
      return 0.0;
    case 1:
      return draws.Uniform(1.0, 1.5);
    case 2:
    case 3:
    case 4:
    case 5:
      return draws.Uniform(0.05, 1.0);
    default:
      return kMindlin;
  }
}

}  // namespace

Truth DrawTruth(Draws& draws) {
  Truth truth;
  truth.law.shape_exponent = DrawShape(draws);
  truth.law.tangential_stiffness = draws.LogUniform(1e3, 1e10);
  truth.law.slip_force = draws.LogUniform(1e-4, 1e6);
  truth.reach = draws.LogUniform(0.8, 4.0);
  truth.cycles = 1 + draws.Index(6);
  truth.samples_per_cycle = 100 + draws.Index(301);
  truth.virgin = draws.Index(2) == 0;
  truth.frequency = draws.LogUniform(0.05, 100.0);
  truth.force_offset = truth.law.slip_force * draws.Uniform(-1.0, 1.0);
  truth.displacement_offset = Amplitude(truth) * draws.Uniform(-2.0, 2.0);
  truth.force_sense = draws.Index(5) == 0 ? -1 : 1;
  return truth;
}

double SlipDisplacement(const models::BranchLaw& law) {
  constexpr double kLogRemaining = -4.605170185988091;  // ln 0.01
  const double beta = 1 - law.shape_exponent;
  const double y =
      beta == 0 ? -kLogRemaining : -std::expm1(beta * kLogRemaining) / beta;  // (1 − u^β)/β
  return y * law.slip_force / law.tangential_stiffness;
}

double Amplitude(const Truth& truth) { return truth.reach * SlipDisplacement(truth.law); }

}  // namespace mindahl::reliability
