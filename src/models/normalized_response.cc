#include "models/normalized_response.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "models/response_gradient.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

namespace {

/// Returns the law with Tc = 1: forces and stiffnesses are those over it.
BranchLaw LawOf(const NormalizedLaw& law) {
  return {
      .tangential_stiffness = law.rate, .shape_exponent = law.shape_exponent, .slip_force = 1.0};
}

/// A general shape whose runs the kernel evaluates.
struct KernelShape : backbone::GeneralShape<double> {};

/// Returns the shape that is fastest for many displacements.
template <typename Shape>
Shape OfMany(const Shape& shape) {
  return shape;
}
KernelShape OfMany(const backbone::GeneralShape<double>& shape) { return {shape}; }

void EvaluateRun(const ScaledBranch& branch, const KernelShape& shape, double /*slip_force*/,
                 double limit, std::span<const double> displacement, std::span<double> t) {
  EvaluateGeneralRun(branch, shape.shape_exponent, limit, displacement, t);
}

/// Computes what the kernel does not: of a branch in series with a spring, or by an asymmetry.
void DifferentiateRun(const backbone::InSeries& shape, const ScaledBranch& branch,
                      const BranchGradient& branch_gradient, double limit,
                      std::span<const double> displacement, std::span<double> t,
                      const NormalizedGradient& gradient) {
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    double force = 0.0;
    const Gradient g = Differentiation::DifferentiateSample(shape, branch, branch_gradient,
                                                            displacement[i], force);
    t[i] = std::clamp(force, -limit, limit);
    for (std::size_t j = 0; j < gradient.size(); ++j) {
      if (!gradient[j].empty()) gradient[j][i] = g[static_cast<Eigen::Index>(j)];
    }
  }
}

}  // namespace

void NormalizedResponse::Evaluate(const FrictionModel& model, const NormalizedLaw& law,
                                  const LoadingPath& path, std::span<const double> displacement,
                                  std::span<double> t, const NormalizedGradient& gradient) {
  const BranchLaw branch_law = LawOf(law);
  Validate(branch_law);
  RequireSizes(path, displacement, "response", t);
  if (IsEmpty(gradient)) {
    WithShapeBehindSpring(law.shape_exponent, law.spring_travel, [&](const auto& shape) {
      EvaluatePath(model, branch_law, law.spring_travel, OfMany(shape), path, displacement, t,
                   branches_);
    });
    return;
  }
  const BranchScaling scaling(model, branch_law, law.spring_travel);
  const double limit = path.limit();
  const SprungShape shape{law.shape_exponent, law.spring_travel};
  ScaleBranches(scaling, path, shape, branches_);
  Differentiation(scaling, shape).Differentiate(path, branches_, gradients_);
  const bool has_kernel = law.spring_travel == 0 && gradient[kAsymmetry].empty();
  if (has_kernel) std::ranges::fill(gradient[kSpring], 0.0);
  for (const BranchRun& run : path.runs) {
    const auto b = static_cast<std::size_t>(run.branch);
    const auto part = [&](std::span<double> column) {
      return column.empty() ? column : column.subspan(run.begin, run.end - run.begin);
    };
    const std::span<const double> places = displacement.subspan(run.begin, run.end - run.begin);
    NormalizedGradient of_run;
    std::ranges::transform(gradient, of_run.begin(), part);
    if (has_kernel) {
      DifferentiateGeneralRun(branches_[b], gradients_[b], law.shape_exponent, limit, places,
                              part(t), of_run);
    } else {
      DifferentiateRun(ShapeOn(shape, branches_[b]), branches_[b], gradients_[b], limit, places,
                       part(t), of_run);
    }
  }
}

/// d is not finite at slip and beyond.
NormalizedDisplacement::Point NormalizedDisplacement::PointOn(const Branch& branch,
                                                              const ForcedLaw& law, double force,
                                                              bool with_gradient) {
  // The difference and what its rounding leaves out (Knuth's sum): next to slip all of it counts.
  const double way = force - branch.origin;
  const double back = way - force;
  const double rest = (force - (way - back)) - (branch.origin + back);
  const double sign = std::copysign(1.0, way);
  const double left = (branch.height - std::abs(way)) - sign * rest;
  if (!(left > 0)) return {.d = std::numeric_limits<double>::quiet_NaN()};
  const double share = std::abs(way) / branch.height;
  const double remaining = left / branch.height;
  const double alpha = law.shape_exponent;
  const double y = ReducedDisplacement(alpha, share, remaining);
  Point point{.d = branch.start.d + sign * branch.unit * y};
  if (!with_gradient) return point;
  const double log_u = share < 0.5 ? std::log1p(-share) : std::log(remaining);
  const double log_v = branch.remaining == 1 ? 0.0 : std::log(branch.remaining);
  const double softening = std::expm1(-alpha * log_u);              // u^{−α} − 1
  const double of_v = log_v == 0 ? 1.0 : std::exp(-alpha * log_v);  // v^{−α}
  const double per_way = of_v * (1 + softening);                    // by |T − T_r|/Tc
  const double per_remaining = -branch.span * of_v * softening;
  point.gradient =
      branch.start.gradient +
      sign * (Eigen::Vector3d(per_way * std::abs(way) / law.slip_force,
                              branch.unit * (ReducedDisplacementPerShape(alpha, log_u) - log_v * y),
                              0.0) +
              per_remaining * branch.remaining_gradient);
  if (branch.is_virgin) point.gradient[2] = -per_way;
  return point;
}

bool NormalizedDisplacement::Evaluate(const FrictionModel& model, const ForcedLaw& law,
                                      const LoadingPath& path, std::span<const double> force,
                                      std::span<double> d, const DisplacementGradient& gradient) {
  RequireSameSize("force", force.size(), "displacement", d.size());
  const bool with_gradient = !IsEmpty(gradient);
  const double zero = UnloadedAt(path);
  branches_.clear();
  branches_.reserve(path.branches.size());
  for (const models::Branch& from : path.branches) {
    const double t = (from.origin - zero) / law.slip_force;
    const bool is_virgin = IsVirgin(from.start);
    const BranchScale scale = model.scale(from.direction * t, is_virgin);
    Branch branch{.origin = from.origin,
                  .height = scale.span * scale.remaining * law.slip_force,
                  .span = scale.span,
                  .remaining = scale.remaining,
                  .unit = scale.span * std::pow(scale.remaining, 1 - law.shape_exponent),
                  .is_virgin = is_virgin,
                  .remaining_gradient =
                      scale.remaining_per_force * from.direction * Eigen::Vector3d(t, 0.0, -1.0)};
    if (from.start == BranchStart::kReversal) {
      const Branch& parent = branches_[static_cast<std::size_t>(from.parent)];
      branch.start = PointOn(parent, law, from.origin, with_gradient);
    } else if (from.start == BranchStart::kSteadyExtreme) {
      // The loop is symmetric: half of the branch to the other extreme lies on either side.
      const double other = from.origin + 2 * from.direction * from.amplitude;
      const Point point = PointOn(branch, law, other, with_gradient);
      branch.start = {-point.d / 2, -point.gradient / 2};
      branch.start.gradient[2] = 0.0;
    }
    branches_.push_back(branch);
  }
  for (const BranchRun& run : path.runs) {
    const Branch& branch = branches_[static_cast<std::size_t>(run.branch)];
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const Point point = PointOn(branch, law, force[i], with_gradient);
      d[i] = point.d;
      if (!std::isfinite(point.d)) return false;
      for (std::size_t j = 0; j < gradient.size(); ++j) {
        const double unit = j == 2 ? law.slip_force : 1.0;
        if (!gradient[j].empty()) gradient[j][i] = point.gradient[static_cast<int>(j)] / unit;
      }
    }
  }
  return true;
}

}  // namespace mindahl::models
