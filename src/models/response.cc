#include "mindahl/models/response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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
struct ScaledBranch {
  double origin = 0.0;
  double force = 0.0;   // t₀
  double height = 1.0;  // span·v
  double rate = 0.0;    // k [1/m]
};

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
  std::vector<ScaledBranch> Scale(const LoadingPath& path, const Shape& shape) const {
    std::vector<ScaledBranch> scaled;
    scaled.reserve(path.branches.size());
    for (const Branch& branch : path.branches) {
      scaled.push_back(Start(branch, OriginForce(branch, scaled, shape)));
    }
    return scaled;
  }

  /// Derivatives of every branch of `scaled`, which Scale made.
  std::vector<BranchGradient> Differentiate(const LoadingPath& path,
                                            std::span<const ScaledBranch> scaled) const {
    std::vector<BranchGradient> gradients;
    gradients.reserve(path.branches.size());
    for (std::size_t i = 0; i < path.branches.size(); ++i) {
      gradients.push_back(DifferentiateStart(path.branches[i], scaled[i].force,
                                             OriginGradient(path.branches[i], scaled, gradients)));
    }
    return gradients;
  }

  /// ∂t/∂(ln rate, α, δ₀) at `displacement`, and t itself.
  Gradient DifferentiateSample(const ScaledBranch& branch, const BranchGradient& gradient,
                               double displacement, double& force) const {
    const double e = displacement - branch.origin;
    const double y = branch.rate * std::abs(e);
    const auto phi = backbone::Differentiate(y, shape_exponent_);
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
    return model_.steady_peak(rate_ * branch.amplitude, shape_exponent_);
  }

  /// Most models do not look at the peak; sparing it keeps a branch as cheap as a sample.
  [[nodiscard]] SteadyPeak PeakThatScales(const Branch& branch) const {
    return model_.scaled_by_peak ? Peak(branch) : SteadyPeak{};
  }

  template <typename Shape>
  [[nodiscard]] double OriginForce(const Branch& branch, std::span<const ScaledBranch> scaled,
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
    const ScaledBranch& parent = scaled[static_cast<std::size_t>(branch.parent)];
    const double e = branch.origin - parent.origin;
    return parent.force + std::copysign(parent.height * shape.Force(parent.rate * std::abs(e)), e);
  }

  [[nodiscard]] BranchScale ScaleOf(const Branch& branch, double origin_force,
                                    const SteadyPeak& peak) const {
    return model_.scale(branch.direction * origin_force, peak.force, IsVirgin(branch.start));
  }

  [[nodiscard]] ScaledBranch Start(const Branch& branch, double origin_force) const {
    const BranchScale scale = ScaleOf(branch, origin_force, PeakThatScales(branch));
    const double slowing =
        scale.remaining == 1.0 ? 1.0 : std::pow(scale.remaining, shape_exponent_ - 1);
    // Finite, lest it meet a zero displacement: α in the thousands overflows the power.
    const double rate = scale.remaining > 0 ? std::min(rate_ * slowing / scale.span,
                                                       std::numeric_limits<double>::max())
                                            : 0.0;
    return {branch.origin, origin_force, scale.span * scale.remaining, rate};
  }

  [[nodiscard]] Gradient OriginGradient(const Branch& branch, std::span<const ScaledBranch> scaled,
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

/// Forces of one run; the loop has no branch and no call, so that it vectorises where φ does.
template <typename Shape>
void EvaluateRun(const ScaledBranch& branch, const Shape& shape, double slip_force, double limit,
                 std::span<const double> displacement, std::span<double> force) {
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const double e = displacement[i] - branch.origin;
    const double t =
        branch.force + std::copysign(branch.height * shape.Force(branch.rate * std::abs(e)), e);
    force[i] = slip_force * std::clamp(t, -limit, limit);
  }
}

/// Rounding must not carry |T| over Tc; a model that does exceed it is left to.
double Limit(const FrictionModel& model) {
  return model.bounded ? 1.0 : std::numeric_limits<double>::max();
}

void RequireSizes(const LoadingPath& path, std::span<const double> displacement,
                  std::span<double> force) {
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  RequireSameSize("displacement", displacement.size(), "loading path",
                  path.runs.empty() ? 0 : path.runs.back().end);
}

}  // namespace

void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const double> displacement, std::span<double> force) {
  Validate(law);
  RequireSizes(path, displacement, force);
  const Evaluation evaluation(model, law);
  backbone::WithShape(law.shape_exponent, [&](const auto& shape) {
    const std::vector<ScaledBranch> branches = evaluation.Scale(path, shape);
    for (const BranchRun& run : path.runs) {
      const std::size_t count = run.end - run.begin;
      EvaluateRun(branches[static_cast<std::size_t>(run.branch)], shape, law.slip_force,
                  Limit(model), displacement.subspan(run.begin, count),
                  force.subspan(run.begin, count));
    }
  });
}

void EvaluateForceAndGradient(const FrictionModel& model, const BranchLaw& law,
                              const LoadingPath& path, std::span<const double> displacement,
                              std::span<double> force, std::span<double> gradient) {
  Validate(law);
  RequireSizes(path, displacement, force);
  RequireSameSize("gradient", gradient.size(), "displacement times gradient columns",
                  displacement.size() * kGradientColumns);
  const Evaluation evaluation(model, law);
  const std::vector<ScaledBranch> branches =
      evaluation.Scale(path, backbone::GeneralShape<double>{law.shape_exponent});
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
