#include "models/normalized_response.h"

#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::models {
namespace {

/// A general shape whose runs the kernel evaluates.
struct KernelShape : backbone::GeneralShape<double> {};

void EvaluateRun(const ScaledBranch& branch, const KernelShape& shape, double /*slip_force*/,
                 double limit, std::span<const double> displacement, std::span<double> t) {
  EvaluateGeneralRun(branch, shape.shape_exponent, limit, displacement, t);
}

/// Returns the derivatives of t at `displacement`, and t itself.
/// @param shape  that of the branch
Gradient DifferentiateSample(const backbone::InSeries& shape, const ScaledBranch& branch,
                             const BranchGradient& gradient, double displacement, double& force) {
  const double e = displacement - branch.origin;
  const auto series = shape.Differentiate(branch.Normalize(e));
  const auto& phi = series.contact;
  const double sign = std::copysign(1.0, e);
  force = branch.force + branch.height * sign * phi.force;
  // κ = h·k·c follows height and rate: Φ + κ∂Φ/∂κ = φ/(1+κφ'), Y∂Φ/∂Y + κ∂Φ/∂κ = yφ'/(1+κφ').
  Gradient result =
      gradient.force + sign * (gradient.height * (series.share * phi.force) +
                               branch.height * (series.share * phi.elastic) * gradient.log_rate);
  if (gradient.runs_both_ways) result[kAsymmetry] *= sign;
  result[kShape] += sign * branch.height * (series.share * phi.shape_derivative);
  result[kUnloaded] -=
      gradient.origin_per_unloaded * branch.height * branch.rate * (series.share * phi.slope);
  result[kSpring] += sign * branch.height * series.log_compliance;
  return result;
}

/// Returns the derivatives of every branch of `scaled`, which ScaleBranches made.
std::vector<BranchGradient> DifferentiateBranches(const BranchScaling& scaling,
                                                  const LoadingPath& path, const NormalizedLaw& law,
                                                  const ScaledBranches& scaled) {
  std::vector<BranchGradient> gradients;
  gradients.reserve(path.branches.size());
  for (const Branch& branch : path.branches) {
    const BranchScale scale = scaling.ScaleOf(branch, scaled[gradients.size()].force);
    BranchGradient& result = gradients.emplace_back();
    if (branch.start == BranchStart::kReversal) {
      const auto parent = static_cast<std::size_t>(branch.parent);
      double force = 0.0;
      result.force = DifferentiateSample(ShapeOn(law, scaled[parent]), scaled[parent],
                                         gradients[parent], branch.origin, force);
    } else if (branch.start == BranchStart::kSteadyCentre) {
      result.force[kAsymmetry] = 1.0;
    } else if (branch.start == BranchStart::kSteadyExtreme) {
      const SteadyPeak peak = scaling.Peak(branch.amplitude);
      result.force[kRate] = -branch.direction * peak.per_log_stiffness;
      result.force[kShape] = -branch.direction * peak.per_shape;
      result.force[kSpring] = -branch.direction * peak.per_log_travel;
    }
    result.log_rate[kRate] = 1.0;
    if (scale.remaining <= 0) continue;
    // The force at the origin changes the height and the rate of the branch.
    const Gradient remaining = scale.remaining_per_force * branch.direction * result.force;
    result.height += scale.span * remaining;
    result.log_rate += (law.shape_exponent - 1) * remaining / scale.remaining;
    result.log_rate[kShape] += std::log(scale.remaining);
    if (branch.start != BranchStart::kUnloaded) continue;
    result.origin_per_unloaded = 1.0;
    // The virgin curve is l·φ(κ|e|/l) with l = VirginLimit(): by a its height grows as l does, and
    // its rate falls as 1/l does.
    result.runs_both_ways = path.asymmetry == 0;
    result.height[kAsymmetry] = result.runs_both_ways ? 1.0 : branch.direction;
    result.log_rate[kAsymmetry] = -result.height[kAsymmetry] / VirginLimit(path, branch);
  }
  return gradients;
}

/// Computes what the kernel does not: of a branch in series with a spring, or by an asymmetry.
void DifferentiateRun(const backbone::InSeries& shape, const ScaledBranch& branch,
                      const BranchGradient& branch_gradient, double limit,
                      std::span<const double> displacement, std::span<double> t,
                      const NormalizedGradient& gradient) {
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    double force = 0.0;
    const Gradient g = DifferentiateSample(shape, branch, branch_gradient, displacement[i], force);
    t[i] = std::clamp(force, -limit, limit);
    for (std::size_t j = 0; j < gradient.size(); ++j) {
      if (!gradient[j].empty()) gradient[j][i] = g[static_cast<Eigen::Index>(j)];
    }
  }
}

// The branch law solved for the displacement, in reduced quantities (docs/theory.md §5):
//   y(φ) = (1 − u^β)/β,  u = 1 − φ the fraction of the branch's height that is left, β = 1 − α.

/// Returns y; no form subtracts what cancels.
/// @param share      φ in [0, 1)
/// @param remaining  u = 1 − φ > 0, with digits of its own next to slip
double ReducedDisplacement(double shape_exponent, double share, double remaining) {
  if (shape_exponent == 0) return share;
  if (shape_exponent == 1.0 / 3) {
    const double root = std::cbrt(remaining);
    return 1.5 * share * (1 + root) / (1 + root + root * root);
  }
  const double log_remaining = share < 0.5 ? std::log1p(-share) : std::log(remaining);
  const double exponent = (1 - shape_exponent) * log_remaining;
  return exponent == 0 ? -log_remaining : -log_remaining * (std::expm1(exponent) / exponent);
}

/// Returns ∂y/∂α = ln²u·(1 − e^z + z·e^z)/z², z = β·ln u; the last factor by its series,
/// Σ (k+1)·zᵏ/(k+2)!, where its terms cancel.
/// @param log_remaining  ln u
double ReducedDisplacementPerShape(double shape_exponent, double log_remaining) {
  const double z = (1 - shape_exponent) * log_remaining;
  constexpr double kCancelling = 0.05;  // beyond it the ninth term is above ε/8 of the first
  const double square = log_remaining * log_remaining;
  if (!(std::abs(z) < kCancelling)) return square * ((z * std::exp(z) - std::expm1(z)) / (z * z));
  double sum = z / 403200;
  for (const double divisor : {45360, 5760, 840, 144, 30, 8, 3}) sum = z * (1 / divisor + sum);
  return square * (0.5 + sum);
}

/// d with its derivatives by −ln Tc, α and T₀/Tc.
struct Point {
  double d = 0.0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

/// A branch along which the force is imposed.
struct ForcedBranch {
  double origin = 0.0;  // T_r [N]
  double height = 0.0;  // m·v·Tc [N]
  BranchScale scale;    // m and v
  double unit = 1.0;    // m·v^β
  bool is_virgin = false;
  Eigen::Vector3d remaining_gradient = Eigen::Vector3d::Zero();  // of v
  Point start = {};                                              // at the origin
};

/// d is not finite at slip and beyond.
Point PointOn(const ForcedBranch& branch, const ForcedLaw& law, double force, bool with_gradient) {
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
  const double log_v = branch.scale.remaining == 1 ? 0.0 : std::log(branch.scale.remaining);
  const double softening = std::expm1(-alpha * log_u);              // u^{−α} − 1
  const double of_v = log_v == 0 ? 1.0 : std::exp(-alpha * log_v);  // v^{−α}
  const double per_way = of_v * (1 + softening);                    // by |T − T_r|/Tc
  const double per_remaining = -branch.scale.span * of_v * softening;
  point.gradient =
      branch.start.gradient +
      sign * (Eigen::Vector3d(per_way * std::abs(way) / law.slip_force,
                              branch.unit * (ReducedDisplacementPerShape(alpha, log_u) - log_v * y),
                              0.0) +
              per_remaining * branch.remaining_gradient);
  if (branch.is_virgin) point.gradient[2] = -per_way;
  return point;
}

}  // namespace

void EvaluateNormalizedForce(const FrictionModel& model, const NormalizedLaw& law,
                             const LoadingPath& path, std::span<const double> displacement,
                             std::span<double> t, const NormalizedGradient& gradient) {
  Validate(BranchLaw{law.rate, law.shape_exponent, 1.0});
  RequireSizes(path, displacement, "response", t);
  if (IsEmpty(gradient)) {
    WithShapeBehindSpring(law, [&]<typename Shape>(const Shape& shape) {
      constexpr bool kHasKernel = std::is_same_v<Shape, backbone::GeneralShape<double>>;
      using Fastest = std::conditional_t<kHasKernel, KernelShape, Shape>;
      EvaluatePath(model, law, Fastest{shape}, 1.0, path, displacement, t);
    });
    return;
  }
  const BranchScaling scaling(model, law);
  const double limit = path.limit();
  const ScaledBranches branches = ScaleBranches(scaling, path, law);
  const std::vector<BranchGradient> gradients = DifferentiateBranches(scaling, path, law, branches);
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
      DifferentiateGeneralRun(branches[b], gradients[b], law.shape_exponent, limit, places, part(t),
                              of_run);
    } else {
      DifferentiateRun(ShapeOn(law, branches[b]), branches[b], gradients[b], limit, places, part(t),
                       of_run);
    }
  }
}

bool EvaluateNormalizedDisplacement(const FrictionModel& model, const ForcedLaw& law,
                                    const LoadingPath& path, std::span<const double> force,
                                    std::span<double> d, const DisplacementGradient& gradient) {
  RequireSameSize("force", force.size(), "displacement", d.size());
  const bool with_gradient = !IsEmpty(gradient);
  // Forces count from the origin of a virgin contact, or from the centre of a steady loop.
  const Branch& first = path.branches.front();
  const bool at_extreme = first.start == BranchStart::kSteadyExtreme;
  const double zero = at_extreme ? first.origin + first.direction * first.amplitude : first.origin;
  std::vector<ForcedBranch> branches;
  branches.reserve(path.branches.size());
  for (const Branch& from : path.branches) {
    const double t = (from.origin - zero) / law.slip_force;
    const bool is_virgin = IsVirgin(from.start);
    const BranchScale scale = model.scale(from.direction * t, is_virgin);
    ForcedBranch branch{.origin = from.origin,
                        .height = scale.span * scale.remaining * law.slip_force,
                        .scale = scale,
                        .unit = scale.span * std::pow(scale.remaining, 1 - law.shape_exponent),
                        .is_virgin = is_virgin,
                        .remaining_gradient = scale.remaining_per_force * from.direction *
                                              Eigen::Vector3d(t, 0.0, -1.0)};
    if (from.start == BranchStart::kReversal) {
      const ForcedBranch& parent = branches[static_cast<std::size_t>(from.parent)];
      branch.start = PointOn(parent, law, from.origin, with_gradient);
    } else if (from.start == BranchStart::kSteadyExtreme) {
      // The loop is symmetric: half of the branch to the other extreme lies on either side.
      const double other = from.origin + 2 * from.direction * from.amplitude;
      const Point point = PointOn(branch, law, other, with_gradient);
      branch.start = {-point.d / 2, -point.gradient / 2};
      branch.start.gradient[2] = 0.0;
    }
    branches.push_back(branch);
  }
  for (const BranchRun& run : path.runs) {
    const ForcedBranch& branch = branches[static_cast<std::size_t>(run.branch)];
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
