#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "mindahl/loop/reversals.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

/// Seeded displacement histories, and the response to them through the library's public steps.
namespace mindahl::testing {

using History = std::vector<double>;
using Generator = std::mt19937_64;

/// The same on every platform, unlike std::uniform_real_distribution.
inline double Uniform(Generator& generator, double low, double high) {
  return low + (high - low) * static_cast<double>(generator() >> 11) * 0x1p-53;
}

inline double Normal(Generator& generator) {  // Box and Muller
  constexpr double kTwoPi = 6.283185307179586;
  const double radius = std::sqrt(-2 * std::log(1 - Uniform(generator, 0, 1)));
  return radius * std::cos(kTwoPi * Uniform(generator, 0, 1));
}

/// Returns a sine of amplitude 1 and mean 0, with a sample at each end.
inline History Sine(double cycles, double samples_per_cycle, double phase = 0.0) {
  History history(static_cast<std::size_t>(std::llround(cycles * samples_per_cycle)) + 1);
  for (std::size_t i = 0; i < history.size(); ++i) {
    history[i] =
        std::sin(phase + 2 * std::numbers::pi * static_cast<double>(i) / samples_per_cycle);
  }
  return history;
}

/// Straight between the extremes of the sine with as many samples.
inline History Triangle(double cycles, double samples_per_cycle) {
  History history = Sine(cycles, samples_per_cycle);
  for (double& displacement : history) {
    displacement = 2 / std::numbers::pi * std::asin(displacement);
  }
  return history;
}

inline History WithNoise(Generator& generator, History history, double deviation) {
  for (double& displacement : history) displacement += deviation * Normal(generator);
  return history;
}

inline History Quantised(History history, double step) {
  for (double& displacement : history) displacement = step * std::round(displacement / step);
  return history;
}

/// Log-uniform between two positive numbers.
inline double LogUniform(Generator& generator, double low, double high) {
  return std::exp(Uniform(generator, std::log(low), std::log(high)));
}

/// Largest magnitude.
inline double Largest(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

inline History RandomWalk(Generator& generator, std::size_t samples, double step) {
  History history(samples);
  double at = 0.0;
  for (double& displacement : history) displacement = at += Uniform(generator, -step, step);
  return history;
}

inline History WhiteSequence(Generator& generator, std::size_t samples, double reach) {
  History history(samples);
  for (double& displacement : history) displacement = Uniform(generator, -reach, reach);
  return history;
}

/// A walk or a white sequence of 3 to 60 samples, of micro to gross slip for a law whose elastic
/// limit is 1, off centre, with dwells.
inline History RandomHistory(Generator& generator) {
  const std::size_t samples = 3 + generator() % 58;
  const double size = LogUniform(generator, 0.03, 5.0);
  History history = generator() % 2 == 0 ? RandomWalk(generator, samples, size)
                                         : WhiteSequence(generator, samples, size);
  const double offset = generator() % 2 == 0 ? 0.0 : Uniform(generator, -size, size);
  for (std::size_t i = 0; i < samples; ++i) {
    history[i] += offset;
    if (i > 0 && generator() % 8 == 0) history[i] = history[i - 1];
  }
  return history;
}

inline models::LoadingPath PathOf(const models::FrictionModel& model,
                                  std::span<const double> displacement,
                                  const models::InitialContact& initial = {}, double gate = 0.0) {
  return models::MakeLoadingPath(displacement, loop::FindReversals(displacement, gate),
                                 model.memory, initial);
}

/// Force [N] at every sample.
inline std::vector<double> Respond(const models::FrictionModel& model, const models::BranchLaw& law,
                                   std::span<const double> displacement,
                                   const models::InitialContact& initial = {},
                                   const models::SeriesSpring& rig = {}) {
  std::vector<double> force(displacement.size());
  models::EvaluateForce(model, law, PathOf(model, displacement, initial), displacement, force, rig);
  return force;
}

inline const models::FrictionModel& Model(std::string_view name) {
  return *models::FindFrictionModel(name);
}

}  // namespace mindahl::testing
