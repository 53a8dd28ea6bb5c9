#include "mindahl/models/normalized_displacement.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "mindahl/core/error.h"
#include "models/reduced_displacement.h"

namespace mindahl::models {
/// @returns false at slip and beyond
bool NormalizedDisplacement::PointOn(const Branch& branch, const ForcedLaw& law, double force,
                                     bool with_gradient, Point& point) {
  const double way = force - branch.origin;
  const double left = branch.height - std::abs(way);
  if (!(left > 0)) return false;
  const double share = std::abs(way) / branch.height;
  const double remaining = left / branch.height;
  const double sign = std::copysign(1.0, way);
  const double alpha = law.shape_exponent;
  const double y = ReducedDisplacement(alpha, share, remaining);
  const double log_v = branch.remaining == 1 ? 0.0 : std::log(branch.remaining);
  const double unit = branch.span * (log_v == 0 ? 1.0 : std::exp((1 - alpha) * log_v));
  point.d = branch.d + sign * unit * y;
  if (!std::isfinite(point.d)) return false;
  if (!with_gradient) return true;
  const double log_u = share < 0.5 ? std::log1p(-share) : std::log(remaining);
  const double softening = std::expm1(-alpha * log_u);              // u^{−α} − 1
  const double of_v = log_v == 0 ? 1.0 : std::exp(-alpha * log_v);  // v^{−α}
  const double per_way = of_v * (1 + softening);                    // by |T − T_r|/Tc
  const double per_remaining = -branch.span * of_v * softening;
  point.per_log_rate = branch.per_log_rate + sign * (per_way * std::abs(way) / law.slip_force +
                                                     per_remaining * branch.remaining_per_log_rate);
  point.per_shape =
      branch.per_shape + sign * unit * (ReducedDisplacementPerShape(alpha, log_u) - log_v * y);
  point.per_zero = branch.is_virgin
                       ? -per_way
                       : branch.per_zero + sign * per_remaining * branch.remaining_per_zero;
  return true;
}

bool NormalizedDisplacement::Differentiate(const FrictionModel& model, const ForcedLaw& law,
                                           const LoadingPath& path, std::span<const double> force,
                                           std::span<double> d,
                                           const DisplacementGradient& gradient) {
  RequireSameSize("force", force.size(), "displacement", d.size());
  if (model.scaled_by_peak) {
    throw InvalidArgument(
        fmt::format("model {} is scaled by the peak: must be another model where the force is "
                    "imposed",
                    model.name));
  }
  const bool with_gradient = !gradient.log_slip_force.empty() || !gradient.shape_exponent.empty() ||
                             !gradient.unloaded_force.empty();
  const double zero = UnloadedAt(path);
  branches_.clear();
  branches_.reserve(path.branches.size());
  Point point;
  for (const models::Branch& from : path.branches) {
    const double t = (from.origin - zero) / law.slip_force;
    const bool is_virgin = IsVirgin(from.start);
    const BranchScale scale = model.scale(from.direction * t, 0.0, is_virgin);
    if (!(scale.remaining > 0)) return false;
    Branch branch{.origin = from.origin,
                  .height = scale.span * scale.remaining * law.slip_force,
                  .span = scale.span,
                  .remaining = scale.remaining,
                  .is_virgin = is_virgin,
                  .remaining_per_log_rate = scale.remaining_per_force * from.direction * t,
                  .remaining_per_zero = -scale.remaining_per_force * from.direction};
    if (from.start == BranchStart::kReversal) {
      const Branch& parent = branches_[static_cast<std::size_t>(from.parent)];
      if (!PointOn(parent, law, from.origin, with_gradient, point)) return false;
      branch.d = point.d;
      branch.per_log_rate = point.per_log_rate;
      branch.per_shape = point.per_shape;
      branch.per_zero = point.per_zero;
    } else if (from.start == BranchStart::kSteadyExtreme) {
      // The loop is symmetric: half of the branch to the other extreme lies on either side.
      const double other = from.origin + 2 * from.direction * from.amplitude;
      if (!PointOn(branch, law, other, with_gradient, point)) return false;
      branch.d = -point.d / 2;
      branch.per_log_rate = -point.per_log_rate / 2;
      branch.per_shape = -point.per_shape / 2;
    }
    branches_.push_back(branch);
  }
  for (const BranchRun& run : path.runs) {
    const Branch& branch = branches_[static_cast<std::size_t>(run.branch)];
    for (std::size_t i = run.begin; i < run.end; ++i) {
      if (!PointOn(branch, law, force[i], with_gradient, point)) return false;
      d[i] = point.d;
      if (!gradient.log_slip_force.empty()) gradient.log_slip_force[i] = -point.per_log_rate;
      if (!gradient.shape_exponent.empty()) gradient.shape_exponent[i] = point.per_shape;
      if (!gradient.unloaded_force.empty()) {
        gradient.unloaded_force[i] = point.per_zero / law.slip_force;
      }
    }
  }
  return true;
}

}  // namespace mindahl::models
