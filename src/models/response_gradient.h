#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/loading_path.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

/// Numbers the parameters on which forces over Tc depend: ln(σ/Tc), α, δ₀, ln c of a spring, c =
/// Tc/k_r its travel at slip, and the asymmetry a of slip forces Tc(1 ± a).
enum ResponseParameter : int { kRate, kShape, kUnloaded, kSpring, kAsymmetry, kParameters };
using Gradient = Eigen::Vector<double, kParameters>;

/// Holds the derivatives of a branch.
struct BranchGradient {
  Gradient force = Gradient::Zero();
  Gradient height = Gradient::Zero();
  Gradient log_rate = Gradient::Zero();
  double origin_per_unloaded = 0.0;  // 1 on the virgin curve, which moves with δ₀
  /// True of a virgin curve that is run both ways, on which a larger limit on one side is a smaller
  /// one on the other: ∂height/∂a has the sign of e there.
  bool runs_both_ways = false;
};

/// The derivatives of a model's branches and of the forces on them.
class Differentiation {
 public:
  Differentiation(const BranchScaling& scaling, const SprungShape& shape)
      : scaling_(scaling), shape_(shape) {}

  /// Writes the derivatives of every branch of `scaled`, which ScaleBranches made.
  void Differentiate(const LoadingPath& path, const ScaledBranches& scaled,
                     std::vector<BranchGradient>& gradients) const {
    gradients.clear();
    gradients.reserve(path.branches.size());
    for (std::size_t i = 0; i < path.branches.size(); ++i) {
      gradients.push_back(DifferentiateStart(path, path.branches[i], scaled[i].force,
                                             OriginGradient(path.branches[i], scaled, gradients)));
    }
  }

  /// Returns the derivatives of t at `displacement`, and t itself.
  /// @param shape  that of the branch
  static Gradient DifferentiateSample(const backbone::InSeries& shape, const ScaledBranch& branch,
                                      const BranchGradient& gradient, double displacement,
                                      double& force) {
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

 private:
  [[nodiscard]] Gradient OriginGradient(const Branch& branch, const ScaledBranches& scaled,
                                        std::span<const BranchGradient> gradients) const {
    Gradient gradient = Gradient::Zero();
    switch (branch.start) {
      case BranchStart::kUnloaded:
        return gradient;
      case BranchStart::kSteadyCentre:
        gradient[kAsymmetry] = 1.0;
        return gradient;
      case BranchStart::kSteadyExtreme: {
        const auto [peak, per_log_spring_travel] = scaling_.Peak(branch.amplitude);
        gradient[kRate] = -branch.direction * peak.per_log_stiffness;
        gradient[kShape] = -branch.direction * peak.per_shape;
        gradient[kSpring] = -branch.direction * per_log_spring_travel;
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

  [[nodiscard]] BranchGradient DifferentiateStart(const LoadingPath& path, const Branch& branch,
                                                  double origin_force,
                                                  const Gradient& origin_gradient) const {
    const BranchScale scale = scaling_.ScaleOf(branch, origin_force);
    BranchGradient result;
    result.force = origin_gradient;
    result.log_rate[kRate] = 1.0;
    if (scale.remaining <= 0) return result;
    // The force at the origin changes the height and the rate of the branch.
    const Gradient remaining = scale.remaining_per_force * branch.direction * origin_gradient;
    result.height += scale.span * remaining;
    result.log_rate += (shape_.shape_exponent - 1) * remaining / scale.remaining;
    result.log_rate[kShape] += std::log(scale.remaining);
    if (branch.start != BranchStart::kUnloaded) return result;
    result.origin_per_unloaded = 1.0;
    // The virgin curve is l·φ(κ|e|/l) with l = VirginLimit(): by a its height grows as l does, and
    // its rate falls as 1/l does.
    result.runs_both_ways = path.asymmetry == 0;
    result.height[kAsymmetry] = result.runs_both_ways ? 1.0 : branch.direction;
    result.log_rate[kAsymmetry] = -result.height[kAsymmetry] / VirginLimit(path, branch);
    return result;
  }

  const BranchScaling& scaling_;
  const SprungShape& shape_;
};

}  // namespace mindahl::models
