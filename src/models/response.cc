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

namespace mindahl {
namespace {

/// Gradient with respect to ln(σ/Tc), α and δ₀: what forces over Tc depend on.
using Gradient = std::array<double, 3>;
constexpr std::size_t kRate = 0;
constexpr std::size_t kShape = 1;
constexpr std::size_t kUnloaded = 2;

/// A branch ready for evaluation: t(δ) = force + height·sgn(e)·φ(rate·|e|), e = δ − origin.
template <typename Real>
struct ScaledBranch {
  Real origin = 0;
  Real force = 0;   // t₀
  Real height = 1;  // span·v
  Real rate = 0;    // k [1/m]

  /// rate·|e|, from which φ does not overflow.
  [[nodiscard]] Real Normalize(Real e) const {
    return rate * std::min(std::abs(e), backbone::Reach(rate));
  }
};

/// Branches are prepared in double for every type of sample: along a history their roundings add
/// up.
using Branches = std::vector<ScaledBranch<double>>;

struct BranchGradient {
  Gradient force{};
  Gradient height{};
  Gradient log_rate{};
  double origin_per_unloaded = 0.0;  // 1 on the virgin curve, which moves with δ₀
};

/// σ/Tc and α, with the model's rules for how branches start from them.
class Evaluation {
 public:
  Evaluation(const FrictionModel& model, const BranchLaw& law)
      : model_(model),
        rate_(law.tangential_stiffness / law.slip_force),
        shape_exponent_(law.shape_exponent) {}

  template <typename Shape>
  Branches Scale(const LoadingPath& path, const Shape& shape) const {
    Branches scaled;
    scaled.reserve(path.branches.size());
    for (const Branch& branch : path.branches) {
      scaled.push_back(Start(branch, OriginForce(branch, scaled, shape)));
    }
    return scaled;
  }

  /// Derivatives of every branch of `scaled`, which Scale made.
  std::vector<BranchGradient> Differentiate(const LoadingPath& path, const Branches& scaled) const {
    std::vector<BranchGradient> gradients;
    gradients.reserve(path.branches.size());
    for (std::size_t i = 0; i < path.branches.size(); ++i) {
      gradients.push_back(DifferentiateStart(path.branches[i], scaled[i].force,
                                             OriginGradient(path.branches[i], scaled, gradients)));
    }
    return gradients;
  }

  /// ∂t/∂(ln rate, α, δ₀) at `displacement`, and t itself.
  Gradient DifferentiateSample(const ScaledBranch<double>& branch, const BranchGradient& gradient,
                               double displacement, double& force) const {
    const double e = displacement - branch.origin;
    const auto phi = backbone::Differentiate(branch.Normalize(e), shape_exponent_);
    const double sign = std::copysign(1.0, e);
    force = branch.force + branch.height * sign * phi.force;
    Gradient result;
    for (std::size_t j = 0; j < result.size(); ++j) {
      result[j] = gradient.force[j] + sign * (gradient.height[j] * phi.force +
                                              branch.height * phi.elastic * gradient.log_rate[j]);
    }
    result[kShape] += sign * branch.height * phi.shape_derivative;
    result[kUnloaded] -= gradient.origin_per_unloaded * branch.height * branch.rate * phi.slope;
    return result;
  }

 private:
  [[nodiscard]] SteadyPeak Peak(const Branch& branch) const {
    const double y = rate_ * std::min(branch.amplitude, backbone::Reach(rate_));
    return model_.steady_peak(y, shape_exponent_);
  }

  /// Most models do not look at the peak; sparing it keeps a branch as cheap as a sample.
  [[nodiscard]] SteadyPeak PeakThatScales(const Branch& branch) const {
    return model_.scaled_by_peak ? Peak(branch) : SteadyPeak{};
  }

  template <typename Shape>
  [[nodiscard]] double OriginForce(const Branch& branch, const Branches& scaled,
                                   const Shape& shape) const {
    switch (branch.start) {
      case BranchStart::kUnloaded:
      case BranchStart::kSteadyCentre:
        return 0.0;
      case BranchStart::kSteadyExtreme:
        return -branch.direction * Peak(branch).force;
      case BranchStart::kReversal:
        break;
    }
    const ScaledBranch<double>& parent = scaled[static_cast<std::size_t>(branch.parent)];
    const double e = branch.origin - parent.origin;
    return parent.force + std::copysign(parent.height * shape.Force(parent.Normalize(e)), e);
  }

  [[nodiscard]] BranchScale ScaleOf(const Branch& branch, double origin_force,
                                    const SteadyPeak& peak) const {
    return model_.scale(branch.direction * origin_force, peak.force, IsVirgin(branch.start));
  }

  /// k = (σ/Tc)·v^{α−1}/span, at most kSteepest: α in the thousands overflows the power.
  [[nodiscard]] double RateOf(const BranchScale& scale) const {
    constexpr double kSteepest = 1e300;  // [1/m], kept from overflow in products with forces
    if (scale.remaining <= 0) return 0.0;
    const double virgin_rate = rate_ / scale.span;
    if (scale.remaining == 1.0) return virgin_rate;
    const double exponent = shape_exponent_ - 1;
    const bool too_steep =
        std::log(virgin_rate) + exponent * std::log(scale.remaining) >= std::log(kSteepest);
    return too_steep ? kSteepest : virgin_rate * std::pow(scale.remaining, exponent);
  }

  [[nodiscard]] ScaledBranch<double> Start(const Branch& branch, double origin_force) const {
    const BranchScale scale = ScaleOf(branch, origin_force, PeakThatScales(branch));
    return {branch.origin, origin_force, scale.span * scale.remaining, RateOf(scale)};
  }

  [[nodiscard]] Gradient OriginGradient(const Branch& branch, const Branches& scaled,
                                        std::span<const BranchGradient> gradients) const {
    switch (branch.start) {
      case BranchStart::kUnloaded:
      case BranchStart::kSteadyCentre:
        return {};
      case BranchStart::kSteadyExtreme: {
        const SteadyPeak peak = Peak(branch);
        return {-branch.direction * peak.per_log_stiffness, -branch.direction * peak.per_shape, 0};
      }
      case BranchStart::kReversal:
        break;
    }
    const auto parent = static_cast<std::size_t>(branch.parent);
    double force = 0.0;
    return DifferentiateSample(scaled[parent], gradients[parent], branch.origin, force);
  }

  [[nodiscard]] BranchGradient DifferentiateStart(const Branch& branch, double origin_force,
                                                  const Gradient& origin_gradient) const {
    const SteadyPeak peak = PeakThatScales(branch);
    const BranchScale scale = ScaleOf(branch, origin_force, peak);
    BranchGradient result;
    result.force = origin_gradient;
    result.origin_per_unloaded = branch.start == BranchStart::kUnloaded ? 1.0 : 0.0;
    result.log_rate[kRate] = 1.0;
    if (scale.remaining <= 0) return result;
    const Gradient peak_gradient = {peak.per_log_stiffness, peak.per_shape, 0};
    for (std::size_t j = 0; j < result.height.size(); ++j) {
      const double remaining = scale.remaining_per_force * branch.direction * origin_gradient[j] +
                               scale.remaining_per_peak * peak_gradient[j];
      result.height[j] = scale.span * remaining;
      result.log_rate[j] += (shape_exponent_ - 1) * remaining / scale.remaining;
    }
    result.log_rate[kShape] += std::log(scale.remaining);
    return result;
  }

  const FrictionModel& model_;
  double rate_;
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

/// Forces of one run; the loop has no branch and no call, so that it vectorises where φ does.
template <typename Real, typename Shape>
void EvaluateRun(const ScaledBranch<Real>& branch, const Shape& shape, Real slip_force, Real limit,
                 std::span<const Real> displacement, std::span<Real> force) {
  const Real reach = backbone::Reach(branch.rate);
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const Real e = displacement[i] - branch.origin;
    const Real phi = shape.Force(branch.rate * std::min(std::abs(e), reach));
    const Real t = branch.force + std::copysign(branch.height * phi, e);
    force[i] = slip_force * std::clamp(t, -limit, limit);
  }
}

/// Rounding must not carry |T| over Tc; a model that does exceed it is left to.
double Limit(const FrictionModel& model) { return model.bounded ? 1.0 : 2.0; }

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
void RequireReach(const BranchLaw& law, const Branches& branches,
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

template <typename Real>
void Evaluate(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
              std::span<const Real> displacement, std::span<Real> force) {
  RequireRange<Real>(law);
  RequireSizes(path, displacement, force);
  const Evaluation evaluation(model, law);
  const Branches branches = backbone::WithShape(
      law.shape_exponent, [&](const auto& shape) { return evaluation.Scale(path, shape); });
  RequireReach(law, branches, displacement);
  backbone::WithShape(Narrow<Real>(law.shape_exponent), [&](const auto& shape) {
    for (const BranchRun& run : path.runs) {
      const std::size_t count = run.end - run.begin;
      EvaluateRun(Narrow<Real>(branches[static_cast<std::size_t>(run.branch)]), shape,
                  static_cast<Real>(law.slip_force), static_cast<Real>(Limit(model)),
                  displacement.subspan(run.begin, count), force.subspan(run.begin, count));
    }
  });
}

}  // namespace

void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const double> displacement, std::span<double> force) {
  Evaluate(model, law, path, displacement, force);
}

void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const float> displacement, std::span<float> force) {
  Evaluate(model, law, path, displacement, force);
}

void EvaluateForceAndGradient(const FrictionModel& model, const BranchLaw& law,
                              const LoadingPath& path, std::span<const double> displacement,
                              std::span<double> force, std::span<double> gradient) {
  RequireRange<double>(law);
  RequireSizes(path, displacement, force);
  RequireSameSize("gradient", gradient.size(), "displacement times gradient columns",
                  displacement.size() * kGradientColumns);
  const Evaluation evaluation(model, law);
  const Branches branches =
      evaluation.Scale(path, backbone::GeneralShape<double>{law.shape_exponent});
  RequireReach(law, branches, displacement);
  const std::vector<BranchGradient> branch_gradients = evaluation.Differentiate(path, branches);
  const double limit = Limit(model);
  for (const BranchRun& run : path.runs) {
    const auto branch = static_cast<std::size_t>(run.branch);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      double t = 0.0;
      const Gradient g = evaluation.DifferentiateSample(branches[branch], branch_gradients[branch],
                                                        displacement[i], t);
      force[i] = law.slip_force * std::clamp(t, -limit, limit);
      double* row = &gradient[i * kGradientColumns];
      row[kPerLogStiffness] = law.slip_force * g[kRate];
      row[kPerShapeExponent] = law.slip_force * g[kShape];
      row[kPerLogSlipForce] = law.slip_force * (t - g[kRate]);
      row[kPerUnloadedDisplacement] = law.slip_force * g[kUnloaded];
    }
  }
}

}  // namespace mindahl
