#include "mindahl/models/response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/extremes.h"
#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

void RequireReach(const BranchLaw& law, const ScaledBranches& branches,
                  std::span<const double> displacement) {
  if (law.shape_exponent <= 1 || displacement.empty()) return;
  const Extremes extremes = ExtremesOf(displacement);
  double farthest = std::max(-extremes.least, extremes.greatest);
  double steepest = 0.0;
  double farthest_origin = 0.0;
  for (const ScaledBranch& branch : branches) {
    steepest = std::max(steepest, branch.rate);
    farthest_origin = std::max(farthest_origin, std::abs(branch.origin));
  }
  farthest += farthest_origin;
  if (farthest <= backbone::Reach(steepest)) return;
  ThrowInvalid("displacement [m]", farthest,
               fmt::format("must be <= {:.3g} times the elastic limit of the steepest branch, "
                           "{:.3g} m, for shape exponents > 1",
                           backbone::kLargestDisplacement, 1 / steepest));
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
  ScaledBranches branches;
  WithShapeBehindSpring(law.shape_exponent, travel, [&](const auto& shape) {
    EvaluatePath(model, law, travel, shape, path, displacement, force, branches);
  });
}

}  // namespace mindahl::models
