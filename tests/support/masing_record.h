#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "support/histories.h"

/// Contacts of Masing's memory whose backbone is no law's of this library, written down anew.
namespace mindahl::testing {

/// F(x), x >= 0: [m] to [N].
using Backbone = std::function<double(double)>;

/// Force [N] along a displacement from an unloaded contact: the surviving extrema's sum, found by
/// Madelung's rules from the displacement alone.
inline std::vector<double> FollowBackbone(const Backbone& backbone, const History& displacement) {
  std::vector<double> force;
  std::vector<double> extrema = {0.0};  // the unloaded contact, then those that survive
  double last = 0.0;
  for (const double at : displacement) {
    const auto direction = [&](std::size_t k) { return extrema[k] - extrema[k - 1]; };
    if (extrema.size() > 1 && (at - last) * (last - extrema.back()) < 0) extrema.push_back(last);
    if (extrema.size() == 1 && last != 0.0 && (at - last) * last < 0) extrema.push_back(last);
    // What is passed is forgotten, two by two; beyond the mirror image of the first, all is.
    while (extrema.size() > 2 &&
           (at - extrema[extrema.size() - 2]) * direction(extrema.size() - 1) <= 0 &&
           std::abs(at - extrema.back()) >=
               std::abs(extrema[extrema.size() - 2] - extrema.back())) {
      const bool is_first = extrema.size() == 3;
      if (is_first) break;
      extrema.pop_back();
      extrema.pop_back();
    }
    if (extrema.size() > 1 && std::abs(at) >= std::abs(extrema[1])) extrema.resize(1);
    double sum = 0.0;
    for (std::size_t k = 0; k < extrema.size(); ++k) {
      const double to = k + 1 < extrema.size() ? extrema[k + 1] : at;
      const double way = to - extrema[k];
      const double scale = k == 0 ? 1.0 : 2.0;
      sum += std::copysign(scale * backbone(std::abs(way) / scale), way);
    }
    force.push_back(sum);
    last = at;
  }
  return force;
}

/// Segalman's (2005) four parameters: slip force [N], stiffness at rest [N/m], χ and β.
struct FourParameterIwan {
  double slip_force = 1000.0;
  double stiffness = 1e7;
  double chi = -0.6;
  double beta = 0.2;

  [[nodiscard]] double Share() const { return beta + (chi + 1) / (chi + 2); }
  /// [m] where it slips as a whole
  [[nodiscard]] double GrossSlip() const { return slip_force * (1 + beta) / (stiffness * Share()); }
  /// ∫₀^x φρ dφ + x∫ₓ^max ρ dφ with ρ = Rφ^χ + S·δ(φ − max)
  [[nodiscard]] double operator()(double x) const {
    const double largest = GrossSlip();
    if (x >= largest) return slip_force;
    const double r = slip_force * (chi + 1) / (std::pow(largest, chi + 2) * Share());
    const double s = slip_force / largest * beta / Share();
    return r * std::pow(x, chi + 2) / (chi + 2) +
           x * (r * (std::pow(largest, chi + 1) - std::pow(x, chi + 1)) / (chi + 1) + s);
  }
};

/// So many Mindlin contacts side by side, their heights the quantiles of an exponential law: σ ∝
/// h^{1/2}, Tc ∝ h^{3/2} of each.
struct Asperities {
  int count = 60;
  double stiffness = 4e7;    ///< [N/m] of all
  double slip_force = 40.0;  ///< [N] of all

  [[nodiscard]] double operator()(double x) const {
    double roots = 0.0;
    double cubes = 0.0;
    for (int i = 1; i <= count; ++i) {
      const double height = -std::log((i - 0.5) / count);
      roots += std::sqrt(height);
      cubes += std::pow(height, 1.5);
    }
    double sum = 0.0;
    for (int i = 1; i <= count; ++i) {
      const double height = -std::log((i - 0.5) / count);
      const double own_slip = slip_force * std::pow(height, 1.5) / cubes;
      const double gross = 1.5 * own_slip / (stiffness * std::sqrt(height) / roots);
      sum += own_slip * (x >= gross ? 1.0 : 1 - std::pow(1 - x / gross, 1.5));
    }
    return sum;
  }
};

}  // namespace mindahl::testing
