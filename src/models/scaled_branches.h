#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::models {

/// Holds the parameters on which T/Tc depends: the force itself is linear in Tc.
struct NormalizedLaw {
  double rate = 0.0;                  ///< κ = σ/Tc [1/m], finite, > 0
  double shape_exponent = 1.0 / 3.0;  ///< α [–], finite, >= 0
  double spring_travel = 0.0;         ///< c = Tc/k_r [m] of a spring in series; 0 without one
};

/// Returns a law over its slip force.
/// @throws InvalidArgument where the rig cannot be accounted for
inline NormalizedLaw Normalized(const BranchLaw& law, const SeriesSpring& rig = {}) {
  Validate(rig);
  // Compared before it is divided by, for no quotient to overflow.
  constexpr double kSoftest = 1 / backbone::kLargestSeriesCompliance;
  if (rig.stiffness < kSoftest * law.tangential_stiffness) {
    ThrowInvalid("series stiffness [N/m]", rig.stiffness,
                 "must be >= 1e-100 of the tangential stiffness");
  }
  return {law.tangential_stiffness / law.slip_force, law.shape_exponent,
          law.slip_force / rig.stiffness};
}

using ScaledBranches = std::vector<ScaledBranch>;

/// φ on a branch. A shape is the same on all of them, ...
template <typename Shape>
const Shape& ShapeOn(const Shape& shape, const ScaledBranch& /*branch*/) {
  return shape;  // NOLINT(bugprone-return-const-ref-from-parameter): lives as long as the shape
}

/// ... but in series with a spring each has its own stiffness in proportion to the spring's, κ =
/// h·k·c: spring and contact together travel Y = y + κφ(y), in units of 1/k.
/// @throws InvalidArgument where the branch is too stiff for the spring
inline backbone::InSeries ShapeOn(const NormalizedLaw& law, const ScaledBranch& branch) {
  const double compliance = branch.height * branch.rate * law.spring_travel;
  if (!(compliance <= backbone::kLargestSeriesCompliance)) {
    ThrowInvalid("stiffness of a branch over the series stiffness [-]", compliance,
                 "must be <= 1e100");
  }
  return {law.shape_exponent, compliance};
}

/// Calls use(shape), of which ShapeOn() makes that of a branch, with the cheapest that is exact for
/// α, or with the law where a spring is in series.
template <typename Use>
void WithShapeBehindSpring(const NormalizedLaw& law, const Use& use) {
  if (law.spring_travel == 0) {
    backbone::WithShape(law.shape_exponent, use);
  } else {
    use(law);
  }
}

/// A model's rules for how branches start, at σ/Tc and α of a law, behind a spring or none.
class BranchScaling {
 public:
  /// @param model  must outlive the object
  BranchScaling(const FrictionModel& model, const NormalizedLaw& law)
      : model_(model), law_(law), series_compliance_(law.rate * law.spring_travel) {}

  /// Returns y* of the contact where spring and contact together turn at Y: y + κ·t*(y) = Y. The
  /// left side is increasing and concave, so that Newton's rule rises to the root from below.
  [[nodiscard]] double ContactAmplitude(double total) const {
    if (series_compliance_ == 0) return total;
    constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();  // of Y
    constexpr int kIterations = 1000;  // next to slip α >> 1 has y grow by 1 + 1/(α−1) each
    double y = std::max(total / (1 + series_compliance_), total - series_compliance_);
    for (int i = 0; i < kIterations && y > 0; ++i) {
      const SteadyPeak peak = model_.steady_peak(y, law_.shape_exponent);
      const double residual = (total - y) - series_compliance_ * peak.force;
      if (residual <= kRounding * total) break;
      y += residual / (1 + series_compliance_ * (peak.per_log_stiffness / y));
    }
    return y;
  }

  /// Peak at the amplitude of spring and contact together, by the implicit function theorem:
  ///   y + κ·t*(y) = Y   ⇒   dt*/dY = t*'/(1 + κt*'),   its stiffness being σ at a given c
  [[nodiscard]] SteadyPeak Peak(double amplitude) const {
    const double y = ContactAmplitude(law_.rate * amplitude);
    const SteadyPeak contact = model_.steady_peak(y, law_.shape_exponent);
    if (series_compliance_ == 0) return contact;
    const double yielding =
        y > 0 ? series_compliance_ * (contact.per_log_stiffness / y) : series_compliance_;
    return {contact.force, contact.per_log_stiffness / (1 + yielding),
            contact.per_shape / (1 + yielding), -contact.force * (yielding / (1 + yielding))};
  }

  [[nodiscard]] BranchScale ScaleOf(const Branch& branch, double origin_force) const {
    return model_.scale(branch.direction * origin_force, IsVirgin(branch.start));
  }

  /// @param limit  VirginLimit() of the branch: by as much it is larger, at the same stiffness
  [[nodiscard]] ScaledBranch Start(const Branch& branch, double origin_force,
                                   double limit = 1.0) const {
    const BranchScale scale = ScaleOf(branch, origin_force);
    double rate = scale.remaining <= 0 ? 0.0 : law_.rate / scale.span;
    if (rate != 0 && scale.remaining != 1) {
      rate *= std::pow(scale.remaining, law_.shape_exponent - 1);
    }
    return {branch.origin, origin_force, scale.span * scale.remaining * limit, rate / limit};
  }

  /// Force over Tc at the branch's origin, `force_of_parent` giving that of the parent there.
  /// @param asymmetry  of the path: a contact that had slipped before carries it everywhere
  template <typename ForceOfParent>
  [[nodiscard]] double OriginForce(const Branch& branch, ForceOfParent&& force_of_parent,
                                   double asymmetry = 0.0) const {
    if (branch.start == BranchStart::kReversal) {
      return force_of_parent(static_cast<std::size_t>(branch.parent));
    }
    if (branch.start == BranchStart::kSteadyExtreme) {
      return -branch.direction * Peak(branch.amplitude).force;
    }
    return branch.start == BranchStart::kSteadyCentre ? asymmetry : 0.0;
  }

 private:
  const FrictionModel& model_;
  NormalizedLaw law_;
  double series_compliance_;  // κ of the virgin curve
};

/// @param shape  φ, as in backbone.h: has Force(y); or the law in series with a spring
template <typename Shape>
ScaledBranches ScaleBranches(const BranchScaling& scaling, const LoadingPath& path,
                             const Shape& shape) {
  ScaledBranches scaled;
  scaled.reserve(path.branches.size());
  for (const Branch& branch : path.branches) {
    const auto force_of_parent = [&](std::size_t parent_index) {
      const ScaledBranch& parent = scaled[parent_index];
      return parent.ForceAt(branch.origin, ShapeOn(shape, parent));
    };
    scaled.push_back(scaling.Start(branch,
                                   scaling.OriginForce(branch, force_of_parent, path.asymmetry),
                                   VirginLimit(path, branch)));
  }
  return scaled;
}

/// @throws InvalidArgument unless a path and what becomes of it are of the displacements
inline void RequireSizes(const LoadingPath& path, std::span<const double> displacement,
                         std::string_view what, std::span<const double> written) {
  RequireSameSize("displacement", displacement.size(), what, written.size());
  RequireSameSize("displacement", displacement.size(), "loading path",
                  path.runs.empty() ? 0 : path.runs.back().end);
}

/// Computes the forces of one run; the loop has no branch or call, and vectorises where φ does.
/// @param limit  the largest |t|
template <typename Shape>
void EvaluateRun(const ScaledBranch& branch, const Shape& shape, double slip_force, double limit,
                 std::span<const double> displacement, std::span<double> force) {
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    force[i] = slip_force * std::clamp(branch.ForceAt(displacement[i], shape), -limit, limit);
  }
}

/// Computes the forces [N] along a path.
/// @param shape  as WithShapeBehindSpring() has it
template <typename Shape>
void EvaluatePath(const FrictionModel& model, const NormalizedLaw& law, const Shape& shape,
                  double slip_force, const LoadingPath& path, std::span<const double> displacement,
                  std::span<double> force) {
  const ScaledBranches branches = ScaleBranches(BranchScaling(model, law), path, shape);
  const double limit = path.limit();
  for (const BranchRun& run : path.runs) {
    const std::size_t count = run.end - run.begin;
    const ScaledBranch& branch = branches[static_cast<std::size_t>(run.branch)];
    EvaluateRun(branch, ShapeOn(shape, branch), slip_force, limit,
                displacement.subspan(run.begin, count), force.subspan(run.begin, count));
  }
}

}  // namespace mindahl::models
