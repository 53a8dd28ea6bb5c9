#include "mindahl/models/response.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "models/scaled_branches.h"

namespace mindahl::models {
namespace {

/// What forces over Tc depend on: ln(σ/Tc), α, δ₀ and, with a spring, ln c, c = Tc/k_r its travel
/// at slip.
constexpr std::size_t kRate = 0;
constexpr std::size_t kShape = 1;
constexpr std::size_t kUnloaded = 2;
constexpr std::size_t kSpring = 3;

/// φ of the contact alone, in the form that InSeries has.
struct DirectShape {
  double shape_exponent;

  [[nodiscard]] double Force(double y) const {
    return backbone::GeneralShape<double>{shape_exponent}.Force(y);
  }
  [[nodiscard]] backbone::SeriesDerivatives<double> Differentiate(double y) const {
    return {.contact = backbone::Differentiate(y, shape_exponent)};
  }
};

/// The derivatives of a model's branches and of the forces on them.
/// @tparam Shape  DirectShape, or a SprungShape
template <typename Shape>
class Differentiation {
 public:
  static constexpr bool kSprung = !std::is_same_v<Shape, DirectShape>;
  static constexpr std::size_t kParameters = kSprung ? kSpring + 1 : kSpring;
  using Gradient = std::array<double, kParameters>;

  struct BranchGradient {
    Gradient force{};
    Gradient height{};
    Gradient log_rate{};
    double origin_per_unloaded = 0.0;  // 1 on the virgin curve, which moves with δ₀
  };

  Differentiation(const BranchScaling& scaling, const BranchLaw& law, const Shape& shape)
      : scaling_(scaling), shape_(shape), shape_exponent_(law.shape_exponent) {}

  /// Derivatives of every branch of `scaled`, which ScaleBranches made.
  std::vector<BranchGradient> Differentiate(const LoadingPath& path,
                                            const ScaledBranches& scaled) const {
    std::vector<BranchGradient> gradients;
    gradients.reserve(path.branches.size());
    for (std::size_t i = 0; i < path.branches.size(); ++i) {
      gradients.push_back(DifferentiateStart(path.branches[i], scaled[i].force,
                                             OriginGradient(path.branches[i], scaled, gradients)));
    }
    return gradients;
  }

  /// ∂t/∂(ln rate, α, δ₀, ln c) at `displacement`, and t itself.
  /// @param shape  that of the branch
  template <typename ShapeOnBranch>
  static Gradient DifferentiateSample(const ShapeOnBranch& shape,
                                      const ScaledBranch<double>& branch,
                                      const BranchGradient& gradient, double displacement,
                                      double& force) {
    const double e = displacement - branch.origin;
    const auto series = shape.Differentiate(branch.Normalize(e));
    const auto& phi = series.contact;
    const double sign = std::copysign(1.0, e);
    force = branch.force + branch.height * sign * phi.force;
    // κ = h·k·c follows height and rate: Φ + κ∂Φ/∂κ = φ/(1+κφ'), Y∂Φ/∂Y + κ∂Φ/∂κ = yφ'/(1+κφ').
    Gradient result;
    for (std::size_t j = 0; j < result.size(); ++j) {
      result[j] = gradient.force[j] +
                  sign * (gradient.height[j] * (series.share * phi.force) +
                          branch.height * (series.share * phi.elastic) * gradient.log_rate[j]);
    }
    result[kShape] += sign * branch.height * (series.share * phi.shape_derivative);
    result[kUnloaded] -=
        gradient.origin_per_unloaded * branch.height * branch.rate * (series.share * phi.slope);
    if constexpr (kSprung) result[kSpring] += sign * branch.height * series.log_compliance;
    return result;
  }

 private:
  [[nodiscard]] Gradient OriginGradient(const Branch& branch, const ScaledBranches& scaled,
                                        std::span<const BranchGradient> gradients) const {
    switch (branch.start) {
      case BranchStart::kUnloaded:
      case BranchStart::kSteadyCentre:
        return {};
      case BranchStart::kSteadyExtreme: {
        const auto [peak, per_log_spring_travel] = scaling_.DifferentiatePeak(branch);
        Gradient gradient{};
        gradient[kRate] = -branch.direction * peak.per_log_stiffness;
        gradient[kShape] = -branch.direction * peak.per_shape;
        if constexpr (kSprung) gradient[kSpring] = -branch.direction * per_log_spring_travel;
        return gradient;
      }
      case BranchStart::kReversal:
        break;
    }
    const auto parent = static_cast<std::size_t>(branch.parent);
    double force = 0.0;
    return DifferentiateSample(ShapeOn(shape_, scaled[parent]), scaled[parent], gradients[parent],
                               branch.origin, force);
  }

  [[nodiscard]] BranchGradient DifferentiateStart(const Branch& branch, double origin_force,
                                                  const Gradient& origin_gradient) const {
    const SteadyPeak peak = scaling_.PeakThatScales(branch);
    const BranchScale scale = scaling_.ScaleOf(branch, origin_force, peak);
    BranchGradient result;
    result.force = origin_gradient;
    result.origin_per_unloaded = branch.start == BranchStart::kUnloaded ? 1.0 : 0.0;
    result.log_rate[kRate] = 1.0;
    if (scale.remaining <= 0) return result;
    const Gradient peak_gradient{peak.per_log_stiffness, peak.per_shape};
    for (std::size_t j = 0; j < result.height.size(); ++j) {
      const double remaining = scale.remaining_per_force * branch.direction * origin_gradient[j] +
                               scale.remaining_per_peak * peak_gradient[j];
      result.height[j] = scale.span * remaining;
      result.log_rate[j] += (shape_exponent_ - 1) * remaining / scale.remaining;
    }
    result.log_rate[kShape] += std::log(scale.remaining);
    return result;
  }

  const BranchScaling& scaling_;
  const Shape& shape_;
  double shape_exponent_;
};

/// To single precision or none. What does not fit it is out of reach: a force that never comes, a
/// branch that is vertical.
template <typename Real>
Real Narrow(double value) {
  constexpr double kLargest = static_cast<double>(std::numeric_limits<Real>::max());
  return static_cast<Real>(std::clamp(value, -kLargest, kLargest));
}

template <typename Real>
ScaledBranch<Real> Narrow(const ScaledBranch<double>& branch) {
  return {Narrow<Real>(branch.origin), Narrow<Real>(branch.force), Narrow<Real>(branch.height),
          Narrow<Real>(branch.rate)};
}

template <typename Real>
void RequireSizes(const LoadingPath& path, std::span<const Real> displacement,
                  std::span<Real> force) {
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  RequireSameSize("displacement", displacement.size(), "loading path",
                  path.runs.empty() ? 0 : path.runs.back().end);
}

/// What Validate does not ask for: that the type of the samples holds the law too.
template <typename Real>
void RequireRange(const BranchLaw& law) {
  Validate(law);
  if constexpr (std::is_same_v<Real, float>) {
    const auto require = [](std::string_view quantity, double value) {
      if (!std::isnormal(Narrow<float>(value)) || value > std::numeric_limits<float>::max()) {
        ThrowInvalid(quantity, value, "must be a normal float, about 2e-38 to 3e38");
      }
    };
    require("slip force [N]", law.slip_force);
    require("tangential stiffness over slip force [1/m]",
            law.tangential_stiffness / law.slip_force);
    if (law.shape_exponent > backbone::kLargestShapeExponent<float>) {
      ThrowInvalid("shape exponent [-]", law.shape_exponent, "must be <= 1e10 in single precision");
    }
  }
}

/// For α <= 1 a force beyond the reach is Tc; for α > 1 it still grows there.
template <typename Real>
void RequireReach(const BranchLaw& law, const ScaledBranches& branches,
                  std::span<const Real> displacement) {
  if (law.shape_exponent <= 1) return;
  double farthest = 0.0;
  for (const Real at : displacement)
    farthest = std::max(farthest, std::abs(static_cast<double>(at)));
  double steepest = 0.0;
  double farthest_origin = 0.0;
  for (const ScaledBranch<double>& branch : branches) {
    steepest = std::max(steepest, branch.rate);
    farthest_origin = std::max(farthest_origin, std::abs(branch.origin));
  }
  farthest += farthest_origin;
  if (farthest > static_cast<double>(backbone::Reach(Narrow<Real>(steepest)))) {
    ThrowInvalid("displacement [m]", farthest,
                 fmt::format("must be <= {:.3g} times the elastic limit of the steepest branch, "
                             "{:.3g} m, for shape exponents > 1",
                             backbone::kLargestDisplacement<Real>, 1 / steepest));
  }
}

/// c = Tc/k_r [m], the spring's travel at slip.
/// @throws InvalidArgument where the rig cannot be accounted for
double SpringTravel(const FrictionModel& model, const BranchLaw& law, const SeriesSpring& rig) {
  Validate(rig);
  if (model.scaled_by_peak) {
    throw InvalidArgument(fmt::format(
        "model {} is scaled by the peak at the contact's own amplitude: must have a rigid rig, not "
        "a series stiffness [N/m] = {:.6g}",
        model.name, rig.stiffness));
  }
  // Compared before it is divided by, for no quotient to overflow.
  constexpr double kSoftest = 1 / backbone::kLargestSeriesCompliance<double>;
  constexpr double kLongest = 1e300;  // [m]
  if (rig.stiffness < kSoftest * law.tangential_stiffness ||
      rig.stiffness < law.slip_force / kLongest) {
    ThrowInvalid("series stiffness [N/m]", rig.stiffness,
                 "must be >= 1e-100 of the tangential stiffness and let the rig travel <= 1e300 m");
  }
  return law.slip_force / rig.stiffness;
}

bool IsRigid(const SeriesSpring& rig) { return std::isinf(rig.stiffness) && rig.stiffness > 0; }

template <typename Real, typename Shape>
void EvaluateRuns(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                  const ScaledBranches& branches, const Shape& shape,
                  std::span<const Real> displacement, std::span<Real> force) {
  for (const BranchRun& run : path.runs) {
    const std::size_t count = run.end - run.begin;
    const ScaledBranch<double>& branch = branches[static_cast<std::size_t>(run.branch)];
    EvaluateRun(Narrow<Real>(branch), ShapeOn(shape, branch), static_cast<Real>(law.slip_force),
                static_cast<Real>(ForceLimit(model)), displacement.subspan(run.begin, count),
                force.subspan(run.begin, count));
  }
}

template <typename Real>
void Evaluate(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
              std::span<const Real> displacement, std::span<Real> force) {
  RequireRange<Real>(law);
  RequireSizes(path, displacement, force);
  const ScaledBranches branches = backbone::WithShape(law.shape_exponent, [&](const auto& shape) {
    return ScaleBranches(BranchScaling(model, law), path, shape);
  });
  RequireReach(law, branches, displacement);
  backbone::WithShape(Narrow<Real>(law.shape_exponent), [&](const auto& shape) {
    EvaluateRuns(model, law, path, branches, shape, displacement, force);
  });
}

void EvaluateInSeries(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                      std::span<const double> displacement, std::span<double> force,
                      const SeriesSpring& rig) {
  RequireRange<double>(law);
  RequireSizes(path, displacement, force);
  const double travel = SpringTravel(model, law, rig);
  backbone::WithShape(law.shape_exponent, [&](const auto& contact) {
    const SprungShape shape{contact, travel};
    const ScaledBranches branches = ScaleBranches(BranchScaling(model, law, travel), path, shape);
    RequireReach(law, branches, displacement);
    EvaluateRuns(model, law, path, branches, shape, displacement, force);
  });
}

template <typename Shape>
void EvaluateWithGradient(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                          const BranchScaling& scaling, const Shape& shape,
                          std::span<const double> displacement, std::span<double> force,
                          std::span<double> gradient) {
  const ScaledBranches branches = ScaleBranches(scaling, path, shape);
  RequireReach(law, branches, displacement);
  const Differentiation differentiation(scaling, law, shape);
  const auto branch_gradients = differentiation.Differentiate(path, branches);
  const double limit = ForceLimit(model);
  for (const BranchRun& run : path.runs) {
    const auto branch = static_cast<std::size_t>(run.branch);
    const auto& shape_on_branch = ShapeOn(shape, branches[branch]);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      double t = 0.0;
      const auto g = differentiation.DifferentiateSample(
          shape_on_branch, branches[branch], branch_gradients[branch], displacement[i], t);
      force[i] = law.slip_force * std::clamp(t, -limit, limit);
      double* row = &gradient[i * kGradientColumns];
      row[kPerLogStiffness] = law.slip_force * g[kRate];
      row[kPerShapeExponent] = law.slip_force * g[kShape];
      row[kPerLogSlipForce] = law.slip_force * (t - g[kRate]);
      row[kPerUnloadedDisplacement] = law.slip_force * g[kUnloaded];
      row[kPerLogSeriesStiffness] = 0.0;
      if constexpr (differentiation.kSprung) {  // c = Tc/k_r
        row[kPerLogSlipForce] += law.slip_force * g[kSpring];
        row[kPerLogSeriesStiffness] = -law.slip_force * g[kSpring];
      }
    }
  }
}

}  // namespace

void Validate(const SeriesSpring& rig) {
  if (!(rig.stiffness > 0)) {
    ThrowInvalid("series stiffness [N/m]", rig.stiffness, "must be > 0, infinite for a rigid rig");
  }
}

double GrossSlipDisplacement(const BranchLaw& law, const SeriesSpring& rig) {
  Validate(law);
  Validate(rig);
  return GrossSlipDisplacement(law) + law.slip_force / rig.stiffness;
}

void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const double> displacement, std::span<double> force,
                   const SeriesSpring& rig) {
  if (IsRigid(rig)) {
    Evaluate(model, law, path, displacement, force);
  } else {
    EvaluateInSeries(model, law, path, displacement, force, rig);
  }
}

void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const float> displacement, std::span<float> force) {
  Evaluate(model, law, path, displacement, force);
}

void EvaluateForceAndGradient(const FrictionModel& model, const BranchLaw& law,
                              const LoadingPath& path, std::span<const double> displacement,
                              std::span<double> force, std::span<double> gradient,
                              const SeriesSpring& rig) {
  RequireRange<double>(law);
  RequireSizes(path, displacement, force);
  RequireSameSize("gradient", gradient.size(), "displacement times gradient columns",
                  displacement.size() * kGradientColumns);
  if (IsRigid(rig)) {
    EvaluateWithGradient(model, law, path, BranchScaling(model, law),
                         DirectShape{law.shape_exponent}, displacement, force, gradient);
    return;
  }
  const double travel = SpringTravel(model, law, rig);
  EvaluateWithGradient(model, law, path, BranchScaling(model, law, travel),
                       SprungShape{backbone::GeneralShape<double>{law.shape_exponent}, travel},
                       displacement, force, gradient);
}

}  // namespace mindahl::models
