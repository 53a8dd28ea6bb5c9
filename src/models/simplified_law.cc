#include "mindahl/models/simplified_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/extremes.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::models {
void EvaluateSimplifiedDahl(const BranchLaw& law, std::span<const double> displacement,
                            std::span<const double> envelope, std::span<double> force) {
  Validate(law);
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    RequireFinite(fmt::format("displacement [m] of sample {}", i), displacement[i]);
  }
  if (displacement.empty()) return;
  if (envelope.empty()) {
    const LoadingPath path =
        MakeLoadingPath(displacement, loop::FindReversals(displacement, 0.0), Memory::kNone, {});
    const BranchLaw equivalent = DahlEquivalent(law, ExtremesOf(displacement).largest_magnitude());
    EvaluateForce(*FindFrictionModel("dahl"), equivalent, path, displacement, force);
    return;
  }
  RequireSameSize("displacement", displacement.size(), "envelope", envelope.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    RequireNonNegative(fmt::format("amplitude [m] of sample {}", i), envelope[i]);
    const double step = displacement[i] - (i > 0 ? displacement[i - 1] : 0.0);
    const double before = i > 0 ? force[i - 1] : 0.0;
    force[i] = SimplifiedDahlStep(law, BackboneForce(law, envelope[i]), before, step);
  }
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
