#include "mindahl/convert/steady_law.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "convert/bouc_wen_shape.h"
#include "mindahl/core/error.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::convert {

using methods::IwanElements;
using models::BranchLaw;

namespace {

void Require(const BoucWenLaw& law) {
  constexpr double kLargestExponent = 20.0;
  RequirePositive("Bouc-Wen stiffness [N/m]", law.stiffness);
  RequirePositive("Bouc-Wen slip force [N]", law.slip_force);
  if (!(law.exponent >= 1 && law.exponent <= kLargestExponent)) {
    ThrowInvalid("Bouc-Wen exponent [-]", law.exponent, "must be in 1 … 20");
  }
  if (!(law.beta > 0 && law.beta <= 1)) {
    ThrowInvalid("Bouc-Wen beta [-]", law.beta, "must be in (0, 1]");
  }
}

/// Force of elements on their virgin curve.
double VirginForce(const IwanElements& elements, double x) {
  double force = 0.0;
  for (std::size_t j = 0; j < elements.size(); ++j) {
    force += std::min(elements.stiffness[j] * x, elements.slip_force[j]);
  }
  return force;
}

struct Rising {
  double amplitude;
  std::span<const double> distance;
  std::span<double> force;

  void operator()(const ModelLaw& of) const {
    const double peak = models::SteadyPeakForce(*of.model, of.law, amplitude);
    const double share = peak / of.law.slip_force;
    const models::BranchScale scale = of.model->scale(-share, share, /*virgin=*/false);
    // t(x) = t₀ + span·v·φ(k·x): the branch law of the stiffness σ·v^α with the limit span·v·Tc.
    const BranchLaw branch{.tangential_stiffness = of.law.tangential_stiffness *
                                                   std::pow(scale.remaining, of.law.shape_exponent),
                           .shape_exponent = of.law.shape_exponent,
                           .slip_force = of.law.slip_force * scale.span * scale.remaining};
    for (std::size_t i = 0; i < distance.size(); ++i) {
      force[i] = models::BackboneForce(branch, distance[i]) - peak;
    }
  }

  void operator()(const BoucWenLaw& law) const {
    Require(law);
    const BoucWenShape shape(law.exponent, law.beta);
    const double rate = law.stiffness / law.slip_force;
    const BoucWenShape::Loop loop = shape.LoopOf(rate * amplitude);
    for (std::size_t i = 0; i < distance.size(); ++i) {
      force[i] = law.slip_force * shape.Rising(loop, rate * distance[i]);
    }
  }

  void operator()(const IwanElements& elements) const {
    const double peak = VirginForce(elements, amplitude);
    for (std::size_t i = 0; i < distance.size(); ++i) {
      force[i] = 2 * VirginForce(elements, distance[i] / 2) - peak;
    }
  }
};

struct Energy {
  double amplitude;

  double operator()(const ModelLaw& of) const {
    return models::SteadyLoopEnergy(*of.model, of.law, amplitude);
  }
  double operator()(const BoucWenLaw& law) const {
    Require(law);
    const BoucWenShape shape(law.exponent, law.beta);
    return law.slip_force * law.slip_force / law.stiffness *
           shape.Energy(law.stiffness / law.slip_force * amplitude);
  }
  double operator()(const IwanElements& elements) const {
    double energy = 0.0;
    for (std::size_t j = 0; j < elements.size(); ++j) {
      const double stick = elements.slip_force[j] / elements.stiffness[j];
      energy += 4 * elements.slip_force[j] * std::max(amplitude - stick, 0.0);
    }
    return energy;
  }
};

}  // namespace

void EvaluateRisingBranch(const SteadyLaw& law, double amplitude, std::span<const double> distance,
                          std::span<double> force) {
  RequirePositive("amplitude [m]", amplitude);
  RequireSameSize("distance", distance.size(), "force", force.size());
  std::visit(Rising{amplitude, distance, force}, law);
}

double LoopEnergy(const SteadyLaw& law, double amplitude) {
  RequirePositive("amplitude [m]", amplitude);
  return std::visit(Energy{amplitude}, law);
}

LoopError CompareLoops(const SteadyLaw& law, const SteadyLaw& reference, double amplitude) {
  constexpr std::size_t kPlaces = 129;
  constexpr double kGrowth = 8.0;  // of the spacing, as an exponent
  std::array<double, kPlaces> distance{};
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double share = static_cast<double>(i) / (kPlaces - 1);
    distance[i] = 2 * amplitude * (std::expm1(kGrowth * share) / std::expm1(kGrowth));
  }
  std::array<double, kPlaces> force{};
  std::array<double, kPlaces> expected{};
  EvaluateRisingBranch(law, amplitude, distance, force);
  EvaluateRisingBranch(reference, amplitude, distance, expected);
  LoopError error;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    error.force = std::max(error.force, std::abs(force[i] - expected[i]));
  }
  error.force /= expected.back();
  const double energy = LoopEnergy(law, amplitude);
  const double lost = LoopEnergy(reference, amplitude);
  error.energy = lost > 0      ? energy / lost - 1
                 : energy == 0 ? 0.0
                               : std::numeric_limits<double>::infinity();
  return error;
}

}  // namespace mindahl::convert
