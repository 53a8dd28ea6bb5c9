#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "../reference/box.h"
#include "../reference/exact_branch_law.h"
#include "../reference/force_and_gradient.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "mindahl/models/steady_loop.h"

/// What is measured of the models, and the bound that each docstring states: one list, which
/// measure_accuracy.cc turns into the table of docs/accuracy.md and
/// tests/reference/accuracy_bounds_test.cc holds the code to.
namespace mindahl::accuracy {

/// Exact values in SI units at the doubles σ, α, Tc and x, rounded to 64 bits.
struct Exact {
  long double force = 0;               // [N]
  long double remaining = 0;           // [-]
  long double slope = 0;               // [N/m]
  long double per_log_stiffness = 0;   // [N]
  long double per_shape = 0;           // [N]
  long double per_log_slip_force = 0;  // [N]
  long double loop_energy = 0;         // [J]
};

struct ExactDahlLoop {
  long double peak = 0;    // [N]
  long double energy = 0;  // [J]
};

template <typename Real>
Exact EvaluateExactly(const models::BranchLaw& law, const Real& x) {
  const Real slip_force(law.slip_force);
  const Real stiffness(law.tangential_stiffness);
  const Real y = stiffness * x / slip_force;
  const auto exact = reference::EvaluateNormalized(Real(law.shape_exponent), y);
  const Real energy_unit = slip_force * slip_force / stiffness;
  const auto rounded = [](const Real& value) { return static_cast<long double>(value); };
  return {.force = rounded(exact.force * slip_force),
          .remaining = rounded(exact.remaining),
          .slope = rounded(exact.slope * stiffness),
          .per_log_stiffness = rounded(exact.per_log_stiffness * slip_force),
          .per_shape = rounded(exact.per_shape * slip_force),
          .per_log_slip_force = rounded(exact.per_log_slip_force * slip_force),
          .loop_energy = rounded(exact.loop_energy * energy_unit)};
}

inline Exact EvaluateExactly(const models::BranchLaw& law, double x) {
  const bool tiny = law.shape_exponent > 0 && law.shape_exponent < 1e-30;
  return tiny ? EvaluateExactly(law, reference::Digits500(x))
              : EvaluateExactly(law, reference::Digits150(x));
}

/// Just short of slip, where ∂f/∂α may be largest; for α < 1.
inline Exact EvaluateShortOfSlip(const models::BranchLaw& law) {
  using Real = reference::Digits500;
  const Real slip =
      Real(law.slip_force) / (Real(law.tangential_stiffness) * (1 - Real(law.shape_exponent)));
  return EvaluateExactly(law, Real(slip * (1 - Real("1e-40"))));
}

template <typename Real>
ExactDahlLoop EvaluateDahlExactly(const models::BranchLaw& law, double amplitude) {
  const Real slip_force(law.slip_force);
  const Real stiffness(law.tangential_stiffness);
  const auto loop = reference::EvaluateDahlLoop(Real(law.shape_exponent),
                                                Real(stiffness * amplitude / slip_force));
  return {static_cast<long double>(Real(loop.peak * slip_force)),
          static_cast<long double>(Real(loop.energy * slip_force * slip_force / stiffness))};
}

inline ExactDahlLoop EvaluateDahlExactly(const models::BranchLaw& law, double amplitude) {
  const bool tiny = law.shape_exponent > 0 && law.shape_exponent < 1e-30;
  return tiny ? EvaluateDahlExactly<reference::Digits500>(law, amplitude)
              : EvaluateDahlExactly<reference::Digits150>(law, amplitude);
}

/// |value − reference| in ε of `Real` times `scale`; half a unit of the smallest denormal is free.
template <typename Real>
double ErrorInEpsilons(Real value, long double reference, long double scale) {
  constexpr long double kUnit = std::numeric_limits<Real>::denorm_min();
  const long double error =
      std::abs(static_cast<long double>(value) - reference) - kUnit * (1 + 1e-9L) / 2;
  if (error <= 0) return 0.0;
  return static_cast<double>(error / (std::abs(scale) * std::numeric_limits<Real>::epsilon()));
}

template <typename Real>
double RelativeError(Real value, long double reference) {
  return ErrorInEpsilons(value, reference, reference);
}

/// One sample on the virgin curve through the library's public steps.
inline double VirginForce(const models::BranchLaw& law, double x) {
  const models::LoadingPath path =
      models::MakeLoadingPath({&x, 1}, {}, models::Memory::kReturnPoint, {});
  double force = 0.0;
  models::EvaluateForce(*models::FindFrictionModel("mindlin-dahl"), law, path,
                        std::span<const double>(&x, 1), std::span<double>(&force, 1));
  return force;
}

struct VirginSample {
  double force = 0;
  double gradient[models::kGradientColumns] = {};
};

inline VirginSample VirginGradient(const models::BranchLaw& law, double x) {
  const models::LoadingPath path =
      models::MakeLoadingPath({&x, 1}, {}, models::Memory::kReturnPoint, {});
  VirginSample sample;
  models::EvaluateForceAndGradient(*models::FindFrictionModel("mindlin-dahl"), law, path, {&x, 1},
                                   {&sample.force, 1}, sample.gradient);
  return sample;
}

/// The gradient along a history knows y to a few roundings only: near slip, for α < 1/2, that moves
/// it by more than its bound. What it may be there lies between the exact values at x(1 ± 4ε).
inline double GradientError(const models::BranchLaw& law, double x, double value,
                            const Exact& exact, long double Exact::*member, long double scale) {
  constexpr int kSteps = 8;  // of half an ε to either side
  constexpr double kNearSlip = 0.01;
  long double low = exact.*member;
  long double high = low;
  const double lambda = x / GrossSlipDisplacement(law);
  if (law.shape_exponent < 0.5 && std::abs(lambda - 1) < kNearSlip) {
    if (std::abs(lambda - 1) < kSteps * std::numeric_limits<double>::epsilon()) {
      const long double at = EvaluateShortOfSlip(law).*member;
      low = std::min(low, at);
      high = std::max(high, at);
    }
    for (int step = -kSteps; step <= kSteps; ++step) {
      const double factor = 1 + step * std::numeric_limits<double>::epsilon() / 2;
      const long double at = EvaluateExactly(law, x * factor).*member;
      low = std::min(low, at);
      high = std::max(high, at);
    }
  }
  return ErrorInEpsilons(value, std::clamp<long double>(value, low, high), scale);
}

struct Measurement {
  std::string function;
  std::string scale;   // what the error is relative to
  double bound = 0.0;  // [ε of the type], as in the docstring
  std::function<double(const models::BranchLaw&, double x, const Exact&)> error;
};

/// In double, and with the public functions' split arithmetic, at every point of the box.
inline std::vector<Measurement> Measurements() {
  const models::FrictionModel& masing = *models::FindFrictionModel("mindlin-dahl");
  return {
      {"BackboneForce", "value", 1.0,
       [](const models::BranchLaw& law, double x, const Exact& exact) {
         return RelativeError(models::BackboneForce(law, x), exact.force);
       }},
      {"BackboneRemaining", "value", 1.0,
       [](const models::BranchLaw& law, double x, const Exact& exact) {
         return RelativeError(models::BackboneRemaining(law, x), exact.remaining);
       }},
      {"SteadyPeakForce, Masing", "value", 6.0,
       [&masing](const models::BranchLaw& law, double x, const Exact& exact) {
         return RelativeError(models::SteadyPeakForce(masing, law, x), exact.force);
       }},
      {"SteadyLoopEnergy, Masing", "value", 1.0,
       [&masing](const models::BranchLaw& law, double x, const Exact& exact) {
         return RelativeError(models::SteadyLoopEnergy(masing, law, x), exact.loop_energy);
       }},
      {"EvaluateForce", "value", 6.0,
       [](const models::BranchLaw& law, double x, const Exact& exact) {
         return RelativeError(VirginForce(law, x), exact.force);
       }},
      {"EvaluateNormalizedForce, force", "value", 6.0,
       [](const models::BranchLaw& law, double x, const Exact& exact) {
         return RelativeError(VirginGradient(law, x).force, exact.force);
       }},
      {"EvaluateNormalizedForce, ln σ", "Tc", 32.0,
       [](const models::BranchLaw& law, double x, const Exact& exact) {
         return GradientError(law, x, VirginGradient(law, x).gradient[models::kPerLogStiffness],
                              exact, &Exact::per_log_stiffness, law.slip_force);
       }},
      {"EvaluateNormalizedForce, α", "Tc", 32.0,
       [](const models::BranchLaw& law, double x, const Exact& exact) {
         return GradientError(law, x, VirginGradient(law, x).gradient[models::kPerShapeExponent],
                              exact, &Exact::per_shape, law.slip_force);
       }},
      {"EvaluateNormalizedForce, ln Tc", "Tc", 32.0,
       [](const models::BranchLaw& law, double x, const Exact& exact) {
         return GradientError(law, x, VirginGradient(law, x).gradient[models::kPerLogSlipForce],
                              exact, &Exact::per_log_slip_force, law.slip_force);
       }},
      {"EvaluateNormalizedForce, δ₀", "σ", 32.0,
       [](const models::BranchLaw& law, double x, const Exact& exact) {
         return GradientError(law, x,
                              -VirginGradient(law, x).gradient[models::kPerUnloadedDisplacement],
                              exact, &Exact::slope, law.tangential_stiffness);
       }},
  };
}

/// Calls visit(law, x) at every point of the box.
template <typename Visit>
void ForEveryPoint(Visit visit) {
  for (const double shape_exponent : reference::kBoxShapeExponents) {
    for (const reference::Scale& scale : reference::kBoxScales) {
      const models::BranchLaw law{scale.stiffness, shape_exponent, scale.slip_force};
      for (const double x : reference::BoxDisplacements(scale, shape_exponent)) visit(law, x);
    }
  }
}

}  // namespace mindahl::accuracy
