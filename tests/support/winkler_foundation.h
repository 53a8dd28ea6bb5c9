#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

/// A Hertz contact with friction as a row of independent springs: the method of dimensionality
/// reduction (Popov & Heß, Method of Dimensionality Reduction in Contact Mechanics and Friction,
/// Springer 2015, ch. 2, 3 and 5). No law of friction but Coulomb's on every spring, no closed
/// form.
namespace mindahl::testing {

struct FoundationOptions {
  double effective_modulus = 1.0;     ///< E* [Pa]
  double tangential_modulus = 0.8;    ///< G̃ = 4/G* [Pa]; 0.82·E* for like bodies with ν = 0.3
  double radius = 1.0;                ///< R [m] of the sphere; g(x) = x²/R is its 1-D profile
  double friction_coefficient = 0.3;  ///< μ
  double largest_load = 1.0;          ///< N [N] at which all springs are in contact
  std::size_t springs = 2000;         ///< on one side; the other is its mirror image
};

class WinklerFoundation {
 public:
  explicit WinklerFoundation(const FoundationOptions& options)
      : options_(options),
        spacing_(std::sqrt(options.radius * Approach(options.largest_load)) /
                 static_cast<double>(options.springs)),
        force_(options.springs, 0.0) {}

  /// The contact as loaded at displacement 0.
  void Press(double normal_load) { approach_ = Approach(normal_load); }

  /// Indentation d [m] of Hertz: N = (4/3)·E*·√R·d^{3/2}.
  [[nodiscard]] double Approach(double normal_load) const {
    const double root =
        std::cbrt(3 * normal_load / (4 * options_.effective_modulus * std::sqrt(options_.radius)));
    return root * root;
  }

  /// 2a·G̃ [N/m]
  [[nodiscard]] double Stiffness(double normal_load) const {
    return 2 * options_.tangential_modulus * std::sqrt(options_.radius * Approach(normal_load));
  }

  /// To displacement δ under load N, straight in (δ, d); returns the tangential force [N].
  double Move(double displacement, double normal_load) {
    const double approach = Approach(normal_load);
    const double step = displacement - displacement_;
    double sum = 0.0;
    for (std::size_t i = 0; i < force_.size(); ++i) {
      const double x = (static_cast<double>(i) + 0.5) * spacing_;
      const double gap = x * x / options_.radius;
      if (gap >= approach) {
        force_[i] = 0.0;
        continue;
      }
      // What comes into contact on the way is only taken along from there.
      const double share = gap > approach_ ? (approach - gap) / (approach - approach_) : 1.0;
      const double limit =
          options_.friction_coefficient * options_.effective_modulus * (approach - gap) * spacing_;
      force_[i] = std::clamp(force_[i] + options_.tangential_modulus * spacing_ * share * step,
                             -limit, limit);
      sum += force_[i];
    }
    displacement_ = displacement;
    approach_ = approach;
    return 2 * sum;
  }

  /// Bound on what the spacing does to a force, over μN, where the force per length has so many
  /// kinks. The midpoint rule errs by dx²/8 of each jump in slope, which is at most 2·μE*·2a/R, and
  /// by 2a·dx²/24 of the curvature 2μE*/R between them; μN = (4/3)·μE*a³/R.
  [[nodiscard]] double SpacingError(double normal_load, double kinks) const {
    const double ratio = spacing_ / std::sqrt(options_.radius * Approach(normal_load));
    return 0.75 * (kinks + 1.0 / 6) * ratio * ratio;
  }

 private:
  FoundationOptions options_;
  double spacing_;
  std::vector<double> force_;
  double displacement_ = 0.0;
  double approach_ = 0.0;
};

}  // namespace mindahl::testing
