#include "identification/slip_force_profile.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mindahl::identification {
namespace {

/// Tc over half the range of the force.
constexpr std::array kGrid = {0.9, 0.95, 1.0, 1.03, 1.1, 1.25, 1.5, 2.0, 3.0, 6.0, 20.0};
/// A barrier this many times the critical ratio high has no valley behind it.
constexpr double kHopeless = 100.0;
constexpr int kBisections = 6;
constexpr double kRigid = 1e3;
/// A likelihood ratio of five standard errors. A loop far from slip would pass for one that slips
/// once in twenty times if the 95 % test decided the verdict.
constexpr double kVerdict = 25.0;

class LikelihoodRatio {
 public:
  LikelihoodRatio(const ForceResidual& residual, const ParameterLayout& layout,
                  const Solution& best, double variance, double effective_share,
                  const FitOptions& options)
      : residual_(residual),
        layout_(layout),
        best_(best),
        scale_(effective_share / variance),
        options_(options) {}

  /// Best fit with θ[index] held.
  [[nodiscard]] Solution At(std::size_t index, double theta,
                            const std::vector<double>& start) const {
    return Solve(residual_, layout_.WithFixed(index, theta), start, options_);
  }

  [[nodiscard]] double Of(const Solution& solution) const {
    return (solution.sum_of_squares - best_.sum_of_squares) * scale_;
  }

 private:
  const ForceResidual& residual_;
  const ParameterLayout& layout_;
  const Solution& best_;
  double scale_;
  const FitOptions& options_;
};

/// α/Tc is what a loop far from slip determines: a start that keeps it.
std::vector<double> Continue(const ParameterLayout& layout, const std::vector<double>& from,
                             double log_slip_force) {
  std::vector<double> start = from;
  if (!layout.parameters()[kShapeExponent].fixed) {
    start[kShapeExponent] *= std::exp(log_slip_force - from[kLogSlipForce]);
  }
  return start;
}

void Include(SlipForceProfile& profile, const std::vector<double>& theta) {
  const auto include = [](Range& range, double value) {
    range.lower = std::min(range.lower, value);
    range.upper = std::max(range.upper, value);
  };
  include(profile.slip_force, theta[kLogSlipForce]);
  include(profile.shape_exponent, theta[kShapeExponent]);
  include(profile.stiffness, theta[kLogStiffness]);
}

}  // namespace

SlipForceProfile ProfileSlipForce(const ForceResidual& residual, const ParameterLayout& layout,
                                  const Solution& best, double variance, double effective_share,
                                  double critical, const FitOptions& options) {
  SlipForceProfile profile;
  const double fitted = best.theta[kLogSlipForce];
  profile.slip_force = {fitted, fitted};
  profile.shape_exponent = {best.theta[kShapeExponent], best.theta[kShapeExponent]};
  profile.stiffness = {best.theta[kLogStiffness], best.theta[kLogStiffness]};
  const ScaledParameter& parameter = layout.parameters()[kLogSlipForce];
  if (parameter.fixed) return profile;
  const LikelihoodRatio ratio(residual, layout, best, variance, effective_share, options);

  const auto walk = [&](bool upwards) {
    std::vector<double> grid;
    for (const double multiple : kGrid) {
      const double theta = std::log(multiple);
      const bool ahead = upwards ? theta > fitted : theta < fitted;
      if (ahead && theta >= parameter.lower && theta <= parameter.upper) grid.push_back(theta);
    }
    if (!upwards) std::ranges::reverse(grid);
    std::vector<double> last_theta = best.theta;
    std::vector<double> accepted_theta = best.theta;  // the outermost accepted point
    double rejected = 0.0;                            // the next point beyond it
    bool any_rejected = false;
    bool far_end_is_open = true;  // by the test of the verdict
    for (const double theta : grid) {
      const Solution solution = ratio.At(kLogSlipForce, theta, Continue(layout, last_theta, theta));
      last_theta = solution.theta;
      const double value = ratio.Of(solution);
      far_end_is_open = value < std::max(critical, kVerdict);
      if (value < critical) {
        Include(profile, solution.theta);
        accepted_theta = solution.theta;
        any_rejected = false;
      } else {
        if (!any_rejected) rejected = theta;
        any_rejected = true;
        if (value > kHopeless * critical) break;
      }
    }
    const bool open =
        far_end_is_open && upwards && (grid.empty() || parameter.upper >= std::log(kGrid.back()));
    if (!any_rejected) return open;
    double outside = rejected;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = accepted_theta[kLogSlipForce] / 2 + outside / 2;
      const Solution solution =
          ratio.At(kLogSlipForce, middle, Continue(layout, accepted_theta, middle));
      if (ratio.Of(solution) < critical) {
        Include(profile, solution.theta);
        accepted_theta = solution.theta;
      } else {
        outside = middle;
      }
    }
    return open;
  };
  walk(/*upwards=*/false);
  profile.open_above = walk(/*upwards=*/true);
  // α rises with Tc along the valley: where its bound ends the valley, the data do not.
  constexpr double kAtBound = 1e-6;
  const ScaledParameter& shape = layout.parameters()[kShapeExponent];
  if (!shape.fixed && profile.shape_exponent.upper >= shape.upper * (1 - kAtBound)) {
    profile.open_above = true;
  }
  return profile;
}

bool StiffnessIsOpenAbove(const ForceResidual& residual, const ParameterLayout& layout,
                          const Solution& best, double variance, double effective_share,
                          double critical, const FitOptions& options) {
  if (layout.parameters()[kLogStiffness].fixed) return false;
  const LikelihoodRatio ratio(residual, layout, best, variance, effective_share, options);
  const Solution rigid =
      ratio.At(kLogStiffness, best.theta[kLogStiffness] + std::log(kRigid), best.theta);
  return ratio.Of(rigid) < critical;
}

}  // namespace mindahl::identification
