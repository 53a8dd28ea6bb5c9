#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/loading_path.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

/// Numbers the parameters on which forces over Tc depend: ln(σ/Tc), α, δ₀ and, with a spring, ln c,
/// c = Tc/k_r its travel at slip.
inline constexpr std::size_t kRate = 0;
inline constexpr std::size_t kShape = 1;
inline constexpr std::size_t kUnloaded = 2;
inline constexpr std::size_t kSpring = 3;

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

/// Calls use(shape) with the shape that derivatives are of: behind a spring unless it is rigid.
/// @param spring_travel  c = Tc/k_r [m], 0 without a spring
template <typename Use>
void WithDifferentiableShape(double shape_exponent, double spring_travel, const Use& use) {
  if (spring_travel == 0) {
    use(DirectShape{shape_exponent});
  } else {
    use(SprungShape{backbone::GeneralShape<double>{shape_exponent}, spring_travel});
  }
}

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

  /// Writes the derivatives of every branch of `scaled`, which ScaleBranches made.
  void Differentiate(const LoadingPath& path, const ScaledBranches& scaled,
                     std::vector<BranchGradient>& gradients) const {
    gradients.clear();
    gradients.reserve(path.branches.size());
    for (std::size_t i = 0; i < path.branches.size(); ++i) {
      gradients.push_back(DifferentiateStart(path.branches[i], scaled[i].force,
                                             OriginGradient(path.branches[i], scaled, gradients)));
    }
  }

  /// Returns how a branch changes with the force over Tc at its origin, in the place of ln rate.
  [[nodiscard]] BranchGradient DifferentiateByOriginForce(const Branch& branch,
                                                          double origin_force) const {
    const SteadyPeak peak = scaling_.PeakThatScales(branch);
    const BranchScale scale = scaling_.ScaleOf(branch, origin_force, peak);
    BranchGradient result;
    result.force[kRate] = 1.0;
    result.origin_per_unloaded = 1.0;
    if (scale.remaining <= 0) return result;
    const double remaining = scale.remaining_per_force * branch.direction;
    result.height[kRate] = scale.span * remaining;
    result.log_rate[kRate] = (shape_exponent_ - 1) * remaining / scale.remaining;
    return result;
  }

  /// Returns ∂t/∂(ln rate, α, δ₀, ln c) at `displacement`, and t itself.
  /// @param shape  that of the branch
  template <typename ShapeOnBranch>
  static Gradient DifferentiateSample(const ShapeOnBranch& shape, const ScaledBranch& branch,
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

}  // namespace mindahl::models
