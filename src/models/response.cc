#include "mindahl/models/response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mindahl/core/error.h"
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

}  // namespace mindahl::models
