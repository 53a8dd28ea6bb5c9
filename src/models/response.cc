#include "mindahl/models/response.h"

#include "mindahl/core/error.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

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
  const NormalizedLaw normalized = Normalized(law, rig);
  WithShapeBehindSpring(normalized, [&](const auto& shape) {
    EvaluatePath(model, normalized, shape, law.slip_force, path, displacement, force);
  });
}

}  // namespace mindahl::models
