#include "mindahl/models/simplified_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/extremes.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::models {
namespace {

void RequireLawAndSamples(const BranchLaw& law, std::span<const double> displacement,
                          std::span<double> force) {
  Validate(law);
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    RequireFinite(fmt::format("displacement [m] of sample {}", i), displacement[i]);
  }
}

void EvaluateSimplifiedDahl(const BranchLaw& law, std::span<const double> displacement,
                            std::span<const double> envelope, std::span<double> force) {
  RequireLawAndSamples(law, displacement, force);
  if (displacement.empty()) return;
  if (envelope.empty()) {
    const auto [lowest, highest] = ExtremesOf(displacement);
    const LoadingPath path =
        MakeLoadingPath(displacement, loop::FindReversals(displacement, 0.0), Memory::kNone, {});
    EvaluateForce(*FindFrictionModel("dahl"), DahlEquivalent(law, std::max(highest, -lowest)), path,
                  displacement, force);
    return;
  }
  RequireSameSize("displacement", displacement.size(), "envelope", envelope.size());
  double last = 0.0;
  double present = 0.0;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    RequireNonNegative(fmt::format("amplitude [m] of sample {}", i), envelope[i]);
    present =
        SimplifiedDahlStep(law, BackboneForce(law, envelope[i]), present, displacement[i] - last);
    force[i] = present;
    last = displacement[i];
  }
}

void EvaluateSpring(const BranchLaw& law, std::span<const double> displacement,
                    std::span<const double> /*envelope*/, std::span<double> force) {
  RequireLawAndSamples(law, displacement, force);
  bool finite = true;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    force[i] = law.tangential_stiffness * displacement[i];
    finite = finite && std::isfinite(force[i]);
  }
  if (!finite) throw InvalidArgument("the force of a spring exceeds the largest double");
}

void EvaluateCoulomb(const BranchLaw& law, std::span<const double> displacement,
                     std::span<const double> /*envelope*/, std::span<double> force) {
  RequireLawAndSamples(law, displacement, force);
  double last = 0.0;
  double present = 0.0;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (displacement[i] > last) present = law.slip_force;
    if (displacement[i] < last) present = -law.slip_force;
    force[i] = present;
    last = displacement[i];
  }
}

constexpr std::array kSimplifiedLaws{
    SimplifiedLaw{"simplified-dahl", "Simplified-Dahl: the steady branch without a virgin phase",
                  EvaluateSimplifiedDahl},
    SimplifiedLaw{"spring", "linear spring: the contact sticks", EvaluateSpring},
    SimplifiedLaw{"coulomb", "Coulomb friction: the contact slides", EvaluateCoulomb},
};

}  // namespace

std::span<const SimplifiedLaw> SimplifiedLaws() { return kSimplifiedLaws; }

const SimplifiedLaw* FindSimplifiedLaw(std::string_view name) {
  const auto law = std::ranges::find(kSimplifiedLaws, name, &SimplifiedLaw::name);
  return law == kSimplifiedLaws.end() ? nullptr : &*law;
}

double SimplifiedDahlStep(const BranchLaw& law, double peak, double force, double step) {
  const double direction = std::copysign(1.0, step);
  const double remaining = 1 - (peak + direction * force) / (2 * law.slip_force);
  if (!(remaining > 0)) return force;
  const BranchLaw branch = {
      .tangential_stiffness = law.tangential_stiffness * std::pow(remaining, law.shape_exponent),
      .shape_exponent = law.shape_exponent,
      .slip_force = 2 * remaining * law.slip_force};
  return force + BackboneForce(branch, step);
}

}  // namespace mindahl::models
