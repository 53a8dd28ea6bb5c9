#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::models {

/// A branch ready for evaluation: t(δ) = force + height·sgn(e)·φ(rate·|e|), e = δ − origin.
template <typename Real>
struct ScaledBranch {
  Real origin = 0;
  Real force = 0;   // t₀
  Real height = 1;  // span·v
  Real rate = 0;    // k [1/m]

  /// Returns rate·|e|, from which φ does not overflow.
  [[nodiscard]] Real Normalize(Real e) const {
    return rate * std::min(std::abs(e), backbone::Reach(rate));
  }
};

/// Branches are prepared in double for every type of sample: along a history their roundings add
/// up.
using ScaledBranches = std::vector<ScaledBranch<double>>;

/// φ on a branch. A shape is the same on all of them, ...
template <typename Shape>
const Shape& ShapeOn(const Shape& shape, const ScaledBranch<double>& /*branch*/) {
  return shape;  // NOLINT(bugprone-return-const-ref-from-parameter): lives as long as the shape
}

/// ... but behind a spring each has its own stiffness in proportion to the spring's.
template <typename Shape>
struct SprungShape {
  Shape contact;
  double spring_travel;  // c = Tc/k_r [m] of the spring at slip
};

/// κ = h·k·c of a branch: spring and contact together travel Y = y + κφ(y), in units of 1/k.
/// @throws InvalidArgument where the branch is too stiff for the spring
inline double SeriesComplianceOn(const ScaledBranch<double>& branch, double spring_travel) {
  const double compliance = branch.height * branch.rate * spring_travel;
  if (!(compliance <= backbone::kLargestSeriesCompliance<double>)) {
    ThrowInvalid("stiffness of a branch over the series stiffness [-]", compliance,
                 "must be <= 1e100");
  }
  return compliance;
}

template <typename Shape>
backbone::InSeries<Shape> ShapeOn(const SprungShape<Shape>& shape,
                                  const ScaledBranch<double>& branch) {
  return {shape.contact, SeriesComplianceOn(branch, shape.spring_travel)};
}

/// A model's rules for how branches start, at σ/Tc and α of a law, behind a spring or none.
class BranchScaling {
 public:
  /// @param model          must outlive the object
  /// @param spring_travel  c = Tc/k_r [m], 0 without a spring
  BranchScaling(const FrictionModel& model, const BranchLaw& law, double spring_travel = 0.0)
      : model_(model),
        rate_(law.tangential_stiffness / law.slip_force),
        shape_exponent_(law.shape_exponent),
        series_compliance_(rate_ * spring_travel) {}

  [[nodiscard]] SteadyPeak Peak(const Branch& branch) const {
    const double y = rate_ * std::min(branch.amplitude, backbone::Reach(rate_));
    return model_.steady_peak(ContactAmplitude(y), shape_exponent_);
  }

  /// Peak at the amplitude of spring and contact together, by the implicit function theorem:
  ///   y + κ·t*(y) = Y   ⇒   dt*/dY = t*'/(1 + κt*')
  struct PeakInSeries {
    SteadyPeak peak;                     // ∂/∂ln σ at a given c
    double per_log_spring_travel = 0.0;  // ∂t*/∂ln c
  };
  [[nodiscard]] PeakInSeries DifferentiatePeak(const Branch& branch) const {
    const SteadyPeak contact = Peak(branch);
    if (series_compliance_ == 0) return {contact};
    const double y = ContactAmplitude(rate_ * std::min(branch.amplitude, backbone::Reach(rate_)));
    const double yielding =
        y > 0 ? series_compliance_ * (contact.per_log_stiffness / y) : series_compliance_;
    return {{contact.force, contact.per_log_stiffness / (1 + yielding),
             contact.per_shape / (1 + yielding)},
            -contact.force * (yielding / (1 + yielding))};
  }

  /// Most models do not look at the peak; sparing it keeps a branch as cheap as a sample.
  [[nodiscard]] SteadyPeak PeakThatScales(const Branch& branch) const {
    return model_.scaled_by_peak ? Peak(branch) : SteadyPeak{};
  }

  [[nodiscard]] BranchScale ScaleOf(const Branch& branch, double origin_force,
                                    const SteadyPeak& peak) const {
    return model_.scale(branch.direction * origin_force, peak.force, IsVirgin(branch.start));
  }

  /// @param limit  VirginLimit() of the branch: by as much it is larger, at the same stiffness
  [[nodiscard]] ScaledBranch<double> Start(const Branch& branch, double origin_force,
                                           double limit = 1.0) const {
    const BranchScale scale = ScaleOf(branch, origin_force, PeakThatScales(branch));
    return {branch.origin, origin_force, scale.span * scale.remaining * limit,
            RateOf(scale) / limit};
  }

  /// Force over Tc at the branch's origin, `force_of_parent` giving that of the parent there.
  /// @param asymmetry  of the path: a contact that had slipped before carries it everywhere
  template <typename ForceOfParent>
  [[nodiscard]] double OriginForce(const Branch& branch, ForceOfParent&& force_of_parent,
                                   double asymmetry = 0.0) const {
    switch (branch.start) {
      case BranchStart::kUnloaded:
        return 0.0;
      case BranchStart::kSteadyCentre:
        return asymmetry;
      case BranchStart::kSteadyExtreme:
        return -branch.direction * Peak(branch).force;
      case BranchStart::kReversal:
        break;
    }
    return force_of_parent(static_cast<std::size_t>(branch.parent));
  }

 private:
  /// Returns y* of the contact where spring and contact together turn at Y: y + κ·t*(y) = Y. The
  /// left side is increasing and concave, so that Newton's rule rises to the root from below.
  [[nodiscard]] double ContactAmplitude(double total) const {
    if (series_compliance_ == 0) return total;
    constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();  // of Y
    constexpr int kIterations = 1000;  // next to slip α >> 1 has y grow by 1 + 1/(α−1) each
    double y = std::max(total / (1 + series_compliance_), total - series_compliance_);
    for (int i = 0; i < kIterations && y > 0; ++i) {
      const SteadyPeak peak = model_.steady_peak(y, shape_exponent_);
      const double residual = (total - y) - series_compliance_ * peak.force;
      if (residual <= kRounding * total) break;
      y += residual / (1 + series_compliance_ * (peak.per_log_stiffness / y));
    }
    return y;
  }

  /// Returns k = (σ/Tc)·v^{α−1}/span, at most kSteepest: α in the thousands overflows the power.
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

  const FrictionModel& model_;
  double rate_;
  double shape_exponent_;
  double series_compliance_;  // κ of the virgin curve
};

/// @param shape  φ, as in backbone.h: has Force(y); or a SprungShape of it
template <typename Shape>
void ScaleBranches(const BranchScaling& scaling, const LoadingPath& path, const Shape& shape,
                   ScaledBranches& scaled) {
  scaled.clear();
  scaled.reserve(path.branches.size());
  for (const Branch& branch : path.branches) {
    const auto force_of_parent = [&](std::size_t parent_index) {
      const ScaledBranch<double>& parent = scaled[parent_index];
      const double e = branch.origin - parent.origin;
      const double phi = ShapeOn(shape, parent).Force(parent.Normalize(e));
      return parent.force + std::copysign(parent.height * phi, e);
    };
    scaled.push_back(scaling.Start(branch,
                                   scaling.OriginForce(branch, force_of_parent, path.asymmetry),
                                   VirginLimit(path, branch)));
  }
}

template <typename Shape>
ScaledBranches ScaleBranches(const BranchScaling& scaling, const LoadingPath& path,
                             const Shape& shape) {
  ScaledBranches scaled;
  ScaleBranches(scaling, path, shape, scaled);
  return scaled;
}

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

/// @throws InvalidArgument always
[[noreturn]] void ThrowBeyondReach(double displacement, double largest, double elastic_limit);

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
    ThrowBeyondReach(farthest, static_cast<double>(backbone::kLargestDisplacement<Real>),
                     1 / steepest);
  }
}

/// Computes the forces of one run; the loop has no branch or call, and vectorises where φ does.
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
inline double ForceLimit(const FrictionModel& model, double asymmetry = 0.0) {
  return model.bounded ? 1 + std::abs(asymmetry) : 2.0;
}

}  // namespace mindahl::models
