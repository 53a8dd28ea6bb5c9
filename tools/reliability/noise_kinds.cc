#include <cmath>
#include <numbers>

#include "kind.h"
#include "simulation.h"

/// Noise other than a little white one of the force.
namespace mindahl::reliability {
namespace {

using loop::Record;

Loop White(const Truth& truth, std::size_t level, Draws& draws) {
  Truth noisy = truth;
  noisy.noise = At(level, {0.02, 0.05, 0.10});
  return {Measured(noisy, draws), AllOf(truth.law)};
}

Loop Autocorrelated(const Truth& truth, std::size_t level, Draws& draws) {
  constexpr double kCorrelation = 0.9;
  Record record = Measured(truth, draws);
  const double scale = At(level, {0.01, 0.03, 0.10}) * truth.law.slip_force;
  double error = scale * draws.Normal();
  for (double& force : record.force) {
    force += error;
    error =
        kCorrelation * error + std::sqrt(1 - kCorrelation * kCorrelation) * scale * draws.Normal();
  }
  return {record, AllOf(truth.law)};
}

Loop HeavyTailed(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double scale = At(level, {0.003, 0.01, 0.03}) * truth.law.slip_force;
  for (double& force : record.force) {
    // Student's t with two degrees of freedom: no variance.
    force += scale * draws.Normal() / std::sqrt(-std::log(draws.Uniform(1e-300, 1.0)));
  }
  return {record, AllOf(truth.law)};
}

Loop GrowsWithForce(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  for (double& force : record.force) force *= 1 + At(level, {0.01, 0.05, 0.15}) * draws.Normal();
  return {record, AllOf(truth.law)};
}

Loop Hum(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double periods = draws.LogUniform(2.0, 25.0);  // a cycle of the drive
  const double phase = draws.Uniform(0.0, 2 * std::numbers::pi);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double angle = 2 * std::numbers::pi * periods * truth.frequency * record.time[i] + phase;
    record.force[i] += At(level, {0.01, 0.03, 0.10}) * truth.law.slip_force * std::sin(angle);
  }
  return {record, AllOf(truth.law)};
}

void Quantise(std::vector<double>& values, double step, Draws& draws) {
  const double phase = draws.Uniform(0.0, 1.0);
  for (double& value : values) value = step * (std::round(value / step + phase) - phase);
}

Loop QuantisedForce(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  Quantise(record.force, 2 * truth.law.slip_force / At(level, {200, 50, 15}), draws);
  return {record, AllOf(truth.law)};
}

Loop QuantisedDisplacement(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  Quantise(record.displacement, 2 * Amplitude(truth) / At(level, {500, 100, 30}), draws);
  return {record, AllOf(truth.law)};
}

Loop NoisyDisplacement(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  for (double& displacement : record.displacement) {
    displacement += At(level, {0.002, 0.01, 0.03}) * Amplitude(truth) * draws.Normal();
  }
  return {record, AllOf(truth.law)};
}

}  // namespace

std::vector<Kind> NoiseKinds() {
  return {
      {"white force noise", Half::kDevelopment, White, "2, 5, 10 % of Tc"},
      {"autocorrelated force noise", Half::kHeldOut, Autocorrelated,
       "1, 3, 10 % of Tc, 0.9 from one sample to the next"},
      {"heavy-tailed force noise", Half::kDevelopment, HeavyTailed,
       "Student's t with 2 degrees of freedom, scale 0.3, 1, 3 % of Tc"},
      {"noise that grows with the force", Half::kHeldOut, GrowsWithForce, "1, 5, 15 % of T"},
      {"mains hum", Half::kDevelopment, Hum,
       "1, 3, 10 % of Tc, 2 to 25 periods a cycle, not in step"},
      {"quantised force", Half::kHeldOut, QuantisedForce, "200, 50, 15 steps over 2Tc"},
      {"quantised displacement", Half::kDevelopment, QuantisedDisplacement,
       "500, 100, 30 steps over 2X"},
      {"noise of the displacement", Half::kHeldOut, NoisyDisplacement, "0.2, 1, 3 % of X, white"},
  };
}

}  // namespace mindahl::reliability
