#include "mindahl/models/friction_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mindahl/models/backbone.h"

namespace mindahl::models {
namespace {

/// Masing: the virgin curve, then the same curve twice as large from every reversal.
BranchScale MasingScale(double /*signed_force*/, bool virgin) {
  return {.remaining = 1.0, .span = virgin ? 1.0 : 2.0};
}

/// Peyret et al. eq. 10: dT/dx = σ(1 − sT/Tc)^α, so v₀ = 1 − s·t₀.
BranchScale DahlScale(double signed_force, bool /*virgin*/) {
  return {.remaining = std::max(1 - signed_force, 0.0), .span = 1.0, .remaining_per_force = -1.0};
}

/// A Masing loop touches the virgin curve at its extremes.
SteadyPeak MasingPeak(double y, double shape_exponent) {
  const auto phi = backbone::Differentiate(y, shape_exponent);
  return {phi.force, phi.elastic, phi.shape_derivative};
}

/// Returns log cosh x without overflow.
double LogCosh(double x) {
  const double magnitude = std::abs(x);
  if (magnitude < 1) {
    const double half = std::sinh(magnitude / 2);
    return std::log1p(2 * half * half);
  }
  return magnitude + (std::log1p(std::exp(-2 * magnitude)) - std::numbers::ln2);
}

/// Returns log(sinh x / x) without overflow.
double LogSinhRatio(double x) {
  constexpr double kOneExponential = 20.0;  // exp(−2x) < ε/8
  const double magnitude = std::abs(x);
  if (magnitude < kOneExponential) return x == 0 ? 0.0 : std::log(std::sinh(x) / x);
  return magnitude - std::log(2 * magnitude);
}

/// Dahl's own steady loop: v grows from 1 − t* to 1 + t* over 2X. With t* = tanh θ that is
///   y(θ) = sinh(βθ)/(β·coshᵝθ),  dy/dθ = cosh(αθ)/cosh^{1+β}θ,  β = 1 − α,
/// free of cancellation; t* = tanh y for α = 1, t* = 1 from y = 2^{β−1}/β on for α < 1.
struct DahlLoop {
  double shape_exponent;
  double beta = 1 - shape_exponent;

  /// Returns log(y(θ)/y).
  [[nodiscard]] double LogRatio(double theta, double y) const {
    return std::log(theta / y) + LogSinhRatio(beta * theta) - beta * LogCosh(theta);
  }
  /// Returns d log y/dθ.
  [[nodiscard]] double LogSlope(double theta) const {
    return std::exp(LogCosh(shape_exponent * theta) - LogCosh(theta) - LogSinhRatio(beta * theta)) /
           theta;
  }
  /// Returns ∂ log y/∂β.
  [[nodiscard]] double LogPerBeta(double theta) const {
    const double x = beta * theta;
    // coth x − 1/x, by its series where these cancel: 2x⁹/93555 < ε/8 of x/3.
    const double langevin =
        std::abs(x) < 0.05 ? x / 3 * (1 - x * x / 15 * (1 - x * x * (2.0 / 21) * (1 - x * x / 10)))
                           : 1 / std::tanh(x) - 1 / x;
    return theta * langevin - LogCosh(theta);
  }
};

/// Returns θ where the loop's amplitude is y, in (0, highest): Newton's rule on ln y(θ), which
/// grows exponentially for α > 1, and bisection where it leaves the bracket.
double SolveAmplitude(const DahlLoop& loop, double y, double highest) {
  constexpr double kTolerance = 2 * std::numeric_limits<double>::epsilon();
  constexpr int kIterations = 500;  // halvings from 20 to kLinear
  double lowest = 0.0;
  double theta = std::min(y, highest / 2);
  for (int i = 0; i < kIterations; ++i) {
    const double log_ratio = loop.LogRatio(theta, y);
    (log_ratio > 0 ? highest : lowest) = theta;
    double next = theta - log_ratio / loop.LogSlope(theta);
    if (!(next > lowest && next < highest)) next = lowest + (highest - lowest) / 2;
    if (std::abs(next - theta) <= kTolerance * theta) return next;
    theta = next;
  }
  return theta;
}

SteadyPeak DahlPeak(double y, double shape_exponent) {
  constexpr double kSaturated = 20.0;  // tanh 20 rounds to 1
  constexpr double kLinear = 1e-120;   // t* = y to rounding for every α, and 1/y is finite above
  if (y < kLinear) return {.force = y, .per_log_stiffness = y};
  const DahlLoop loop{shape_exponent};
  if (loop.LogRatio(kSaturated, y) <= 0) return {.force = 1.0};
  const double theta = SolveAmplitude(loop, y, kSaturated);
  const double cosh = std::cosh(theta);
  const double per_log_amplitude = 1 / (cosh * cosh * loop.LogSlope(theta));
  return {std::tanh(theta), per_log_amplitude, loop.LogPerBeta(theta) * per_log_amplitude};
}

using enum Memory;
constexpr std::array kModels = {
    FrictionModel{"mindlin-dahl", "Masing law with free shape exponent (Full-Dahl)", kReturnPoint,
                  std::nullopt, MasingScale, MasingPeak},
    FrictionModel{"mindlin", "Mindlin's sphere contact", kReturnPoint, 1.0 / 3.0, MasingScale,
                  MasingPeak},
    FrictionModel{"jenkins", "Jenkins element: spring and Coulomb slider", kReturnPoint, 0.0,
                  MasingScale, MasingPeak},
    FrictionModel{"dahl", "Dahl's own law", kNone, std::nullopt, DahlScale, DahlPeak},
};

}  // namespace

std::span<const FrictionModel> FrictionModels() { return kModels; }

const FrictionModel* FindFrictionModel(std::string_view name) {
  const auto model = std::ranges::find(kModels, name, &FrictionModel::name);
  return model == kModels.end() ? nullptr : &*model;
}

}  // namespace mindahl::models
