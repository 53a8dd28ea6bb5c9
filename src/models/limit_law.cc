#include "mindahl/models/limit_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "mindahl/core/error.h"

namespace mindahl::models {
namespace {

void RequireLawAndSamples(const BranchLaw& law, std::span<const double> displacement,
                          std::span<double> force) {
  Validate(law);
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (!std::isfinite(displacement[i])) {
      ThrowInvalid(fmt::format("displacement [m] of sample {}", i), displacement[i],
                   "must be finite");
    }
  }
}

void EvaluateSpring(const BranchLaw& law, std::span<const double> displacement,
                    std::span<double> force) {
  RequireLawAndSamples(law, displacement, force);
  bool finite = true;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    force[i] = law.tangential_stiffness * displacement[i];
    finite = finite && std::isfinite(force[i]);
  }
  if (!finite) throw InvalidArgument("the force of a spring exceeds the largest double");
}

void EvaluateCoulomb(const BranchLaw& law, std::span<const double> displacement,
                     std::span<double> force) {
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

constexpr std::array kLaws{
    LimitLaw{"spring", "linear spring: the contact sticks", EvaluateSpring},
    LimitLaw{"coulomb", "Coulomb friction: the contact slides", EvaluateCoulomb},
};

}  // namespace

std::span<const LimitLaw> LimitLaws() { return kLaws; }

const LimitLaw* FindLimitLaw(std::string_view name) {
  const auto law = std::ranges::find(kLaws, name, &LimitLaw::name);
  return law == kLaws.end() ? nullptr : &*law;
}

}  // namespace mindahl::models
