#include "mindahl/models/response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/loading_path.h"
#include "models/normalized_response.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

void ThrowBeyondReach(double displacement, double largest, double elastic_limit) {
  ThrowInvalid("displacement [m]", displacement,
               fmt::format("must be <= {:.3g} times the elastic limit of the steepest branch, "
                           "{:.3g} m, for shape exponents > 1",
                           largest, elastic_limit));
}

void Validate(const SeriesSpring& rig) {
  if (!(rig.stiffness > 0)) {
    ThrowInvalid("series stiffness [N/m]", rig.stiffness, "must be > 0, infinite for a rigid rig");
  }
}

void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const double> displacement, std::span<double> force,
                   const SeriesSpring& rig) {
  Validate(law);
  RequireSizes(path, displacement, "force", force);
  const double travel = IsRigid(rig) ? 0.0 : SpringTravel(law, rig);
  WithShapeBehindSpring(law.shape_exponent, travel, [&](const auto& shape) {
    EvaluatePath(model, law, travel, shape, path, displacement, force);
  });
}

namespace {

void RequireForces(const BranchLaw& law, std::span<const double> force) {
  if (force.empty()) throw InvalidArgument("the force history is empty: must have samples");
  if (law.slip_force > kLargestPathDisplacement) {
    ThrowInvalid("slip force [N]", law.slip_force, "must be <= 1e307 N under an imposed force");
  }
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (!(std::abs(force[i]) < law.slip_force)) {
      ThrowInvalid(fmt::format("force [N] of sample {}", i), force[i],
                   fmt::format("must be within the slip force, {} N, where the contact slides",
                               law.slip_force));
    }
  }
}

double RequireDisplacement(std::size_t sample, double force, double displacement) {
  if (!(std::abs(displacement) <= kLargestPathDisplacement)) {
    ThrowInvalid(fmt::format("force [N] of sample {}", sample), force,
                 "is too near the slip force: its displacement exceeds 1e307 m or rounding hides "
                 "how far from slip it is");
  }
  return displacement;
}

}  // namespace

void EvaluateDisplacement(const FrictionModel& model, const BranchLaw& law,
                          std::span<const double> force, std::span<double> displacement,
                          const SeriesSpring& rig) {
  Validate(law);
  Validate(rig);
  RequireSameSize("force", force.size(), "displacement", displacement.size());
  RequireForces(law, force);
  // Rules and bounds are the same numbers, in newtons.
  const LoadingPath path = MakeLoadingPath(force, loop::FindReversals(force, 0.0), model.memory,
                                           {.state = InitialState::kVirgin});
  NormalizedDisplacement normalized;
  normalized.Evaluate(model, {law.slip_force, law.shape_exponent}, path, force, displacement);
  const double elastic_limit = law.slip_force / law.tangential_stiffness;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double contact = elastic_limit * displacement[i];
    displacement[i] = RequireDisplacement(i, force[i], contact + force[i] / rig.stiffness);
  }
}

}  // namespace mindahl::models
