#include "mindahl/models/variable_load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::models {
namespace {

BranchLaw ReferenceLaw(const LoadDependentLaw& law) {
  return {law.reference_stiffness, law.shape_exponent,
          law.friction_coefficient * law.reference_load};
}

/// Elements from `inner` outward, to the next zone or the rim, whose rest positions lie on the line
/// r(h) = intercept + slope·h.
struct Zone {
  double inner = 0.0;       // h₁ [m]
  double slope = 0.0;       // r' [–], within ±1; ±1 where the last slip was in that sense
  double intercept = 0.0;   // r(0) [m], of the line
  double force = 0.0;       // Σ r'·ΔTc [N] over the zones within
  double slip_force = 0.0;  // Tc(h₁) [N]

  [[nodiscard]] double RestAt(double h) const { return intercept + slope * h; }
};

/// A contact moved along a path. The zones cover 0 <= h < δc, innermost first; the elements at the
/// rim carry nothing, so that δ need not be kept with them.
template <typename Shape>
class MovedContact {
 public:
  MovedContact(const LoadDependentLaw& law, const Shape& shape, double first_load)
      : law_(law),
        shape_(shape),
        reference_slip_displacement_(GrossSlipDisplacement(ReferenceLaw(law))),
        zones_{Zone{}} {
    SetLoad(first_load);
  }

  /// To displacement δ and load N, straight in (δ, δc).
  double Move(double displacement, double normal_load) {
    const double step = displacement - displacement_;
    const double slip_displacement_before = slip_displacement_;
    const double slip_force_before = slip_force_;
    if (normal_load != normal_load_) SetLoad(normal_load);
    const double widening = slip_displacement_ - slip_displacement_before;
    if (slip_displacement_ == 0) {
      zones_.clear();
      force_ = 0.0;
    } else if (widening < 0) {
      ShedRim();
      Slip(displacement, displacement - zones_.back().RestAt(slip_displacement_));
    } else if (widening < std::abs(step)) {
      Slip(displacement, step);
    } else if (widening > 0) {
      Widen(step / widening, slip_displacement_before, slip_force_before);
    }
    displacement_ = displacement;
    force_ = std::clamp(force_, -slip_force_, slip_force_);
    return force_;
  }

  /// Is the last load within the range of the arithmetic?
  [[nodiscard]] bool LoadIsInRange() const {
    return slip_displacement_ <= kLargestPathDisplacement && std::isfinite(slip_force_);
  }

 private:
  void SetLoad(double normal_load) {
    normal_load_ = normal_load;
    slip_force_ = law_.friction_coefficient * normal_load;
    slip_displacement_ = reference_slip_displacement_ * ShareOfReferenceSlipDisplacement();
  }

  /// (N/N_ref)^{1−α}
  [[nodiscard]] double ShareOfReferenceSlipDisplacement() const {
    const double load_ratio = normal_load_ / law_.reference_load;
    if (law_.shape_exponent == 1.0 / 3) {
      const double root = std::cbrt(load_ratio);
      return root * root;
    }
    return std::pow(load_ratio, 1 - law_.shape_exponent);
  }

  /// The load rises faster than anything can slip: elements come into contact at the rim, each
  /// resting where δ is when it does.
  void Widen(double slope, double rim, double rim_slip_force) {
    zones_.push_back({.inner = rim,
                      .slope = slope,
                      .intercept = displacement_ - slope * rim,
                      .force = force_,
                      .slip_force = rim_slip_force});
    force_ += slope * (slip_force_ - rim_slip_force);
  }

  /// Forgets what a falling load lifts off.
  void ShedRim() {
    while (zones_.back().inner >= slip_displacement_) zones_.pop_back();
  }

  /// An annulus slips to the rest positions δ − s·(δc − h), s the sign of `stretch`, which is δ − r
  /// at the rim. As |r'| <= 1, what slips is outside of what sticks.
  void Slip(double displacement, double stretch) {
    const double s = std::copysign(1.0, stretch);
    const double intercept = displacement - s * slip_displacement_;
    while (!zones_.empty()) {
      const Zone& stuck = zones_.back();
      // What the rim exceeds its slip limit by, and how fast that falls inward.
      const double excess = std::max(s * (displacement - stuck.RestAt(slip_displacement_)), 0.0);
      const double rate = 1 - s * stuck.slope;
      if (excess < rate * (slip_displacement_ - stuck.inner)) {
        const double width = excess / rate;
        const double share = shape_.Force(width / (slip_displacement_ * (1 - law_.shape_exponent)));
        const double stuck_slip_force = slip_force_ * (1 - share);
        const double stuck_force =
            stuck.force + stuck.slope * (stuck_slip_force - stuck.slip_force);
        zones_.push_back({slip_displacement_ - width, s, intercept, stuck_force, stuck_slip_force});
        force_ = stuck_force + s * slip_force_ * share;
        return;
      }
      zones_.pop_back();
    }
    zones_.push_back({.slope = s, .intercept = intercept});
    force_ = s * slip_force_;
  }

  const LoadDependentLaw& law_;
  const Shape& shape_;
  double reference_slip_displacement_;
  std::vector<Zone> zones_;
  double displacement_ = 0.0;
  double normal_load_ = 0.0;
  double slip_displacement_ = 0.0;  // δc(N)
  double slip_force_ = 0.0;         // Tc(N)
  double force_ = 0.0;
};

void RequireSample(std::size_t sample, double displacement, double normal_load) {
  if (!(std::abs(displacement) <= kLargestPathDisplacement)) {
    ThrowInvalid(fmt::format("displacement [m] of sample {}", sample), displacement,
                 "must be finite and within +-1e307 m");
  }
  if (!(normal_load >= 0) || std::isinf(normal_load)) {
    ThrowInvalid(fmt::format("normal load [N] of sample {}", sample), normal_load,
                 "must be finite and >= 0");
  }
}

}  // namespace

void Validate(const LoadDependentLaw& law) {
  RequirePositive("friction coefficient [-]", law.friction_coefficient);
  RequirePositive("reference load [N]", law.reference_load);
  RequirePositive("reference stiffness [N/m]", law.reference_stiffness);
  RequireNonNegative("shape exponent [-]", law.shape_exponent);
  if (law.shape_exponent >= 1) {
    ThrowInvalid("shape exponent [-]", law.shape_exponent,
                 "must be < 1 under a varying load: slip is complete at a finite displacement");
  }
  const BranchLaw reference = ReferenceLaw(law);
  Validate(reference);
  const double slip_displacement = GrossSlipDisplacement(reference);
  if (!(slip_displacement <= kLargestPathDisplacement)) {
    ThrowInvalid("gross-slip displacement [m] at the reference load", slip_displacement,
                 "must be <= 1e307 m");
  }
}

BranchLaw BranchLawAtLoad(const LoadDependentLaw& law, double normal_load) {
  Validate(law);
  RequirePositive("normal load [N]", normal_load);
  const double load_ratio = normal_load / law.reference_load;
  const double growth = law.shape_exponent == 1.0 / 3 ? std::cbrt(load_ratio)
                                                      : std::pow(load_ratio, law.shape_exponent);
  const BranchLaw at_load{law.reference_stiffness * growth, law.shape_exponent,
                          law.friction_coefficient * normal_load};
  Validate(at_load);
  return at_load;
}

void EvaluateForceUnderLoad(const LoadDependentLaw& law, std::span<const double> displacement,
                            std::span<const double> normal_load, std::span<double> force) {
  Validate(law);
  RequireSameSize("displacement", displacement.size(), "normal load", normal_load.size());
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  if (displacement.empty()) return;
  backbone::WithShape(law.shape_exponent, [&](const auto& shape) {
    RequireSample(0, displacement[0], normal_load[0]);
    MovedContact contact(law, shape, normal_load[0]);
    for (std::size_t i = 0; i < displacement.size(); ++i) {
      RequireSample(i, displacement[i], normal_load[i]);
      force[i] = contact.Move(displacement[i], normal_load[i]);
      if (!contact.LoadIsInRange()) {
        ThrowInvalid(fmt::format("normal load [N] of sample {}", i), normal_load[i],
                     "must keep the slip force finite and its displacement <= 1e307 m");
      }
    }
  });
}

}  // namespace mindahl::models
