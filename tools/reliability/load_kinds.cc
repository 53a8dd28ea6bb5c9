#include <algorithm>
#include <cmath>
#include <numbers>

#include "../../tests/support/variable_load.h"
#include "kind.h"
#include "simulation.h"

/// A normal load that does not stay what it was.
namespace mindahl::reliability {
namespace {

using loop::Record;

/// N over its mean, by the phase of the drive in cycles.
template <typename Load>
Loop UnderLoad(const Truth& truth, double variation, Draws& draws, Load load) {
  constexpr double kFriction = 0.5;
  constexpr double kLargestShape = 0.95;  // the law under load slips at a finite displacement
  Truth loaded = truth;
  loaded.law.shape_exponent = std::min(truth.law.shape_exponent, kLargestShape);
  const testing::LoadDependentLaw law{kFriction, loaded.law.slip_force / kFriction,
                                      loaded.law.tangential_stiffness, loaded.law.shape_exponent};
  const Motion motion = Sine(loaded, draws);
  std::vector<double> normal_load;
  for (const double time : motion.time) {
    normal_load.push_back(
        law.reference_load *
        (1 + variation * load(time * truth.frequency, motion.time.back() * truth.frequency)));
  }
  Record record = Drive(motion, [&](std::span<const double> displacement, std::span<double> force) {
    testing::EvaluateForceUnderLoad(law, displacement, normal_load, force);
  });
  record.normal_load.assign(normal_load.begin() + static_cast<std::ptrdiff_t>(motion.unseen),
                            normal_load.end());
  AddNoise(record, truth, draws);
  Expected expected = AllOf(loaded.law);
  const auto [lowest, highest] = std::ranges::minmax(record.normal_load);
  expected.slip_force = Range{kFriction * lowest, kFriction * highest};
  const auto stiffness_at = [&](double normal) {
    return law.reference_stiffness * std::pow(normal / law.reference_load, law.shape_exponent);
  };
  expected.sigma = Range{stiffness_at(lowest), stiffness_at(highest)};
  return {record, expected};
}

Loop LoadInStep(const Truth& truth, std::size_t level, Draws& draws) {
  const double phase = draws.Uniform(0.0, 2 * std::numbers::pi);
  return UnderLoad(truth, At(level, {0.05, 0.20, 0.60}), draws, [phase](double cycles, double) {
    return std::sin(2 * std::numbers::pi * cycles + phase);
  });
}

Loop TwiceAsFast(const Truth& truth, std::size_t level, Draws& draws) {
  const double phase = draws.Uniform(0.0, 2 * std::numbers::pi);
  return UnderLoad(truth, At(level, {0.05, 0.20, 0.60}), draws, [phase](double cycles, double) {
    return std::sin(4 * std::numbers::pi * cycles + phase);
  });
}

Loop Ramp(const Truth& truth, std::size_t level, Draws& draws) {
  return UnderLoad(truth, At(level, {0.05, 0.20, 0.60}), draws,
                   [](double cycles, double last) { return 2 * cycles / last - 1; });
}

/// As at twice the frequency; the file does not have the load.
Loop Unseen(const Truth& truth, std::size_t level, Draws& draws) {
  Loop loop = TwiceAsFast(truth, level, draws);
  loop.record.normal_load.clear();
  return loop;
}

}  // namespace

std::vector<Kind> LoadKinds() {
  return {
      {"load varies in step", Half::kHeldOut, LoadInStep,
       "by 5, 20, 60 % at the frequency of the drive; sigma and Tc may be those of any load"},
      {"load varies twice as fast", Half::kDevelopment, TwiceAsFast,
       "by 5, 20, 60 % at twice the frequency; sigma and Tc may be those of any load"},
      {"load ramp", Half::kHeldOut, Ramp,
       "from 5, 20, 60 % below to as much above; sigma and Tc may be those of any load"},
      {"load varies and is not recorded", Half::kDevelopment, Unseen,
       "by 5, 20, 60 % at twice the frequency; sigma and Tc may be those of any load"},
  };
}

}  // namespace mindahl::reliability
