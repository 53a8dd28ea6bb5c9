#include "models/normalized_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "models/branch_kernel.h"
#include "models/response_gradient.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

namespace {

using RigidDifferentiation = Differentiation<DirectShape>;
using SprungDifferentiation = Differentiation<SprungShape<backbone::GeneralShape<double>>>;

/// Returns the law with Tc = 1: forces and stiffnesses are those over it.
BranchLaw LawOf(const NormalizedLaw& law) {
  return {
      .tangential_stiffness = law.rate, .shape_exponent = law.shape_exponent, .slip_force = 1.0};
}

/// Computes forces over Tc of one run.
template <typename ShapeOnBranch>
void EvaluateResponseRun(const ScaledBranch& branch, const ShapeOnBranch& shape, double limit,
                         std::span<const double> displacement, std::span<double> t) {
  models::EvaluateRun(branch, shape, 1.0, limit, displacement, t);
}
void EvaluateResponseRun(const ScaledBranch& branch, const backbone::GeneralShape<double>& shape,
                         double limit, std::span<const double> displacement, std::span<double> t) {
  EvaluateGeneralRun(branch, shape.shape_exponent, limit, displacement, t);
}

template <typename ShapeOnBranch>
void DifferentiateRun(const ShapeOnBranch& shape, const ScaledBranch& branch,
                      const SprungDifferentiation::BranchGradient& branch_gradient, double limit,
                      std::span<const double> displacement, std::span<double> t,
                      const NormalizedGradient& gradient) {
  const auto keep = [](std::span<double> column, std::size_t i, double value) {
    if (!column.empty()) column[i] = value;
  };
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    double force = 0.0;
    const auto g = SprungDifferentiation::DifferentiateSample(shape, branch, branch_gradient,
                                                              displacement[i], force);
    t[i] = std::clamp(force, -limit, limit);
    keep(gradient.log_rate, i, g[kRate]);
    keep(gradient.shape_exponent, i, g[kShape]);
    keep(gradient.unloaded_displacement, i, g[kUnloaded]);
    keep(gradient.log_spring_travel, i, g[kSpring]);
  }
}
void DifferentiateRun(const DirectShape& shape, const ScaledBranch& branch,
                      const RigidDifferentiation::BranchGradient& branch_gradient, double limit,
                      std::span<const double> displacement, std::span<double> t,
                      const NormalizedGradient& gradient) {
  DifferentiateGeneralRun(branch, branch_gradient, shape.shape_exponent, limit, displacement, t,
                          gradient);
  std::ranges::fill(gradient.log_spring_travel, 0.0);
}

/// Computes ∂t/∂a. A virgin branch of limit l = 1 ± a is t = ±l·Φ(κ|e|/l), so that it is Φ − YΦ′ in
/// either direction; on every other it is what it was where the branch starts, which a steady
/// contact has as 1.
template <typename Shape>
void DifferentiateByAsymmetry(const Shape& shape, const LoadingPath& path,
                              const ScaledBranches& branches, std::span<const double> displacement,
                              std::vector<double>& per_origin, std::span<double> per_asymmetry) {
  const auto at = [&](std::size_t b, double x) {
    if (path.branches[b].start != BranchStart::kUnloaded) return per_origin[b];
    const ScaledBranch& branch = branches[b];
    const double e = x - branch.origin;
    const auto series = ShapeOn(shape, branch).Differentiate(branch.Normalize(e));
    // Where the two curves are one the sign is that of e, else the branch's direction decides.
    const double sense =
        path.asymmetry == 0 ? 1.0 : std::copysign(1.0, e) * path.branches[b].direction;
    return sense * series.share * (series.contact.force - series.contact.elastic);
  };
  per_origin.resize(branches.size());
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const Branch& branch = path.branches[b];
    const bool is_steady = branch.start == BranchStart::kSteadyCentre;
    per_origin[b] = branch.start == BranchStart::kReversal
                        ? at(static_cast<std::size_t>(branch.parent), branch.origin)
                    : is_steady ? 1.0
                                : 0.0;
  }
  for (const BranchRun& run : path.runs) {
    for (std::size_t i = run.begin; i < run.end; ++i) {
      per_asymmetry[i] = at(static_cast<std::size_t>(run.branch), displacement[i]);
    }
  }
}

}  // namespace

void NormalizedResponse::Evaluate(const FrictionModel& model, const NormalizedLaw& law,
                                  const LoadingPath& path, std::span<const double> displacement,
                                  std::span<double> t) {
  const BranchLaw branch_law = LawOf(law);
  Validate(branch_law);
  RequireSizes(path, displacement, "response", t);
  const BranchScaling scaling(model, branch_law, law.spring_travel);
  const double limit = ForceLimit(model, path.asymmetry);
  WithShapeBehindSpring(law.shape_exponent, law.spring_travel, [&](const auto& shape) {
    ScaleBranches(scaling, path, shape, branches_);
    RequireReach(branch_law, branches_, displacement);
    for (const BranchRun& run : path.runs) {
      const std::size_t count = run.end - run.begin;
      const ScaledBranch& branch = branches_[static_cast<std::size_t>(run.branch)];
      EvaluateResponseRun(branch, ShapeOn(shape, branch), limit,
                          displacement.subspan(run.begin, count), t.subspan(run.begin, count));
    }
  });
}

void NormalizedResponse::Differentiate(const FrictionModel& model, const NormalizedLaw& law,
                                       const LoadingPath& path,
                                       std::span<const double> displacement, std::span<double> t,
                                       const NormalizedGradient& gradient) {
  if (gradient.empty()) {
    Evaluate(model, law, path, displacement, t);
    return;
  }
  const BranchLaw branch_law = LawOf(law);
  Validate(branch_law);
  RequireSizes(path, displacement, "response", t);
  const BranchScaling scaling(model, branch_law, law.spring_travel);
  const double limit = ForceLimit(model, path.asymmetry);
  const auto differentiate = [&](const auto& shape) {
    ScaleBranches(scaling, path, shape, branches_);
    RequireReach(branch_law, branches_, displacement);
    const Differentiation differentiation(scaling, branch_law, shape);
    auto& gradients = GradientsOf(differentiation);
    differentiation.Differentiate(path, branches_, gradients);
    if (!gradient.asymmetry.empty()) {
      DifferentiateByAsymmetry(shape, path, branches_, displacement, per_asymmetry_,
                               gradient.asymmetry);
    }
    for (const BranchRun& run : path.runs) {
      const auto b = static_cast<std::size_t>(run.branch);
      const auto part = [&](std::span<double> column) {
        return column.empty() ? column : column.subspan(run.begin, run.end - run.begin);
      };
      DifferentiateRun(ShapeOn(shape, branches_[b]), branches_[b], gradients[b], limit,
                       displacement.subspan(run.begin, run.end - run.begin), part(t),
                       {.log_rate = part(gradient.log_rate),
                        .shape_exponent = part(gradient.shape_exponent),
                        .unloaded_displacement = part(gradient.unloaded_displacement),
                        .log_spring_travel = part(gradient.log_spring_travel)});
    }
  };
  WithDifferentiableShape(law.shape_exponent, law.spring_travel, differentiate);
}

void NormalizedResponse::DifferentiateByOrigins(const FrictionModel& model,
                                                const NormalizedLaw& law, const LoadingPath& path,
                                                std::span<const double> displacement,
                                                OriginSensitivity& sensitivity) {
  const BranchLaw branch_law = LawOf(law);
  Validate(branch_law);
  const BranchScaling scaling(model, branch_law, law.spring_travel);
  const std::size_t count = path.branches.size();
  sensitivity.slope.assign(count, 0.0);
  sensitivity.gain.assign(count, 0.0);
  sensitivity.per_amplitude.assign(count, 0.0);
  sensitivity.origin_force.resize(count);
  sensitivity.sample_slope.resize(displacement.size());
  sensitivity.sample_gain.resize(displacement.size());
  const auto differentiate = [&](const auto& shape) {
    ScaleBranches(scaling, path, shape, branches_);
    const Differentiation differentiation(scaling, branch_law, shape);
    auto& by_origin = GradientsOf(differentiation);
    by_origin.clear();
    const auto at = [&](std::size_t b, double x, double& slope, double& gain) {
      double force = 0.0;
      const auto g = differentiation.DifferentiateSample(ShapeOn(shape, branches_[b]), branches_[b],
                                                         by_origin[b], x, force);
      slope = -g[kUnloaded];
      gain = g[kRate];
    };
    for (std::size_t b = 0; b < count; ++b) {
      const Branch& branch = path.branches[b];
      sensitivity.origin_force[b] = branches_[b].force;
      if (branch.start == BranchStart::kReversal) {
        at(static_cast<std::size_t>(branch.parent), branch.origin, sensitivity.slope[b],
           sensitivity.gain[b]);
      } else if (branch.start == BranchStart::kSteadyExtreme) {
        sensitivity.per_amplitude[b] = -branch.direction *
                                       scaling.DifferentiatePeak(branch).peak.per_log_stiffness /
                                       branch.amplitude;
      }
      by_origin.push_back(differentiation.DifferentiateByOriginForce(branch, branches_[b].force));
    }
    for (const BranchRun& run : path.runs) {
      for (std::size_t i = run.begin; i < run.end; ++i) {
        at(static_cast<std::size_t>(run.branch), displacement[i], sensitivity.sample_slope[i],
           sensitivity.sample_gain[i]);
      }
    }
  };
  WithDifferentiableShape(law.shape_exponent, law.spring_travel, differentiate);
}

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
  point.d = branch.start.d + sign * unit * y;
  if (!std::isfinite(point.d)) return false;
  if (!with_gradient) return true;
  const double log_u = share < 0.5 ? std::log1p(-share) : std::log(remaining);
  const double softening = std::expm1(-alpha * log_u);              // u^{−α} − 1
  const double of_v = log_v == 0 ? 1.0 : std::exp(-alpha * log_v);  // v^{−α}
  const double per_way = of_v * (1 + softening);                    // by |T − T_r|/Tc
  const double per_remaining = -branch.span * of_v * softening;
  point.per_log_rate =
      branch.start.per_log_rate + sign * (per_way * std::abs(way) / law.slip_force +
                                          per_remaining * branch.remaining_per_log_rate);
  point.per_shape = branch.start.per_shape +
                    sign * unit * (ReducedDisplacementPerShape(alpha, log_u) - log_v * y);
  point.per_zero = branch.is_virgin
                       ? -per_way
                       : branch.start.per_zero + sign * per_remaining * branch.remaining_per_zero;
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
  if (!(law.slip_force > 0)) return false;  // the exponential of its logarithm may underflow
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
      if (!PointOn(parent, law, from.origin, with_gradient, branch.start)) return false;
    } else if (from.start == BranchStart::kSteadyExtreme) {
      // The loop is symmetric: half of the branch to the other extreme lies on either side.
      const double other = from.origin + 2 * from.direction * from.amplitude;
      if (!PointOn(branch, law, other, with_gradient, point)) return false;
      branch.start = {.d = -point.d / 2,
                      .per_log_rate = -point.per_log_rate / 2,
                      .per_shape = -point.per_shape / 2};
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
