#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kind.h"
#include "simulation.h"

/// Faults of a sensor and its amplifier.
namespace mindahl::reliability {
namespace {

using loop::Record;

std::vector<double> Delayed(const std::vector<double>& values, std::size_t samples) {
  std::vector<double> delayed(values);
  for (std::size_t i = samples; i < values.size(); ++i) delayed[i] = values[i - samples];
  for (std::size_t i = 0; i < samples; ++i) delayed[i] = values.front();
  return delayed;
}

/// The first rows, that lag has no reading for, are cut.
Loop ForceLags(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const auto samples = static_cast<std::size_t>(At(level, {1, 3, 6}));
  record.force = Delayed(record.force, samples);
  return {Part(record, samples, record.size()), AllOf(truth.law)};
}

Loop DisplacementLags(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const auto samples = static_cast<std::size_t>(At(level, {1, 3, 6}));
  record.displacement = Delayed(record.displacement, samples);
  return {Part(record, samples, record.size()), AllOf(truth.law)};
}

Loop ForceSaturates(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double limit = At(level, {0.98, 0.90, 0.70}) * truth.law.slip_force;
  const bool on_both_sides = draws.Index(2) == 0;
  for (double& force : record.force) {
    force = std::clamp(force, on_both_sides ? -limit : -HUGE_VAL, limit);
  }
  return {record, AllOf(truth.law)};
}

Loop GainDrifts(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double last = 1 + At(level, {0.01, 0.05, 0.20});
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] *= 1 + (last - 1) * Progress(record, i);
  }
  Expected expected = AllOf(truth.law);
  expected.sigma->highest *= last;
  expected.slip_force->highest *= last;
  return {record, expected};
}

Loop OffsetDrifts(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += At(level, {0.02, 0.10, 0.40}) * truth.law.slip_force * Progress(record, i);
  }
  return {record, AllOf(truth.law)};
}

Loop TemperatureDrifts(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double rate = draws.LogUniform(0.3, 5.0);  // over the record
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.displacement[i] += At(level, {0.02, 0.10, 0.40}) * Amplitude(truth) *
                              std::expm1(-rate * Progress(record, i)) / std::expm1(-rate);
  }
  return {record, AllOf(truth.law)};
}

Loop ForceLowPass(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double keeps = std::exp(-1 / At(level, {1, 3, 8}));
  double filtered = record.force.front();
  for (double& force : record.force) {
    filtered = keeps * filtered + (1 - keeps) * force;
    force = filtered;
  }
  return {record, AllOf(truth.law)};
}

Loop ForceSmoothed(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const auto reach = static_cast<std::size_t>(At(level, {2, 7, 20}));
  std::vector<double> smoothed(record.size());
  for (std::size_t i = 0; i < record.size(); ++i) {
    const std::size_t begin = i - std::min(i, reach);
    const std::size_t end = std::min(i + reach + 1, record.size());
    for (std::size_t k = begin; k < end; ++k) smoothed[i] += record.force[k];
    smoothed[i] /= static_cast<double>(end - begin);
  }
  record.force = smoothed;
  return {record, AllOf(truth.law)};
}

Loop DeadBand(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double reach = At(level, {0.005, 0.02, 0.08}) * Amplitude(truth);
  double reading = record.displacement.front();
  for (double& displacement : record.displacement) {
    reading = std::clamp(reading, displacement - reach, displacement + reach);
    displacement = reading;
  }
  return {record, AllOf(truth.law)};
}

Loop CrossTalkOnForce(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double gain = At(level, {0.02, 0.10, 0.30}) * truth.law.slip_force / Amplitude(truth) *
                      (draws.Index(2) == 0 ? 1 : -1);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += gain * record.displacement[i];
  }
  return {record, AllOf(truth.law)};
}

Loop CrossTalkOnDisplacement(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double compliance = -At(level, {0.02, 0.10, 0.30}) / truth.law.tangential_stiffness;
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.displacement[i] += compliance * record.force[i];
  }
  const double apparent =
      1 / (1 / truth.law.tangential_stiffness + compliance);  // a spring in series, below zero
  return {record, StiffnessAndSlipForce(apparent, truth.law.slip_force)};
}

Loop CurvedDisplacement(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  for (double& displacement : record.displacement) {
    const double share = displacement / Amplitude(truth);
    displacement *= 1 - At(level, {0.01, 0.05, 0.20}) * share * share;
  }
  Expected expected = AllOf(truth.law);
  expected.sigma.reset();
  return {record, expected};
}

/// The force's clock goes faster than the displacement's: readings of one row drift apart.
Loop ForceClockIsFast(const Truth& truth, std::size_t level, Draws& draws) {
  Truth driven = truth;
  driven.cycles = 8;
  const Record record = Measured(driven, draws);
  const double rate = 1 + At(level, {0.0005, 0.001, 0.002});
  std::vector<double> force;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double place = rate * static_cast<double>(i);
    const auto before = static_cast<std::size_t>(place);
    if (before + 1 >= record.size()) break;
    const double between = place - static_cast<double>(before);
    force.push_back((1 - between) * record.force[before] + between * record.force[before + 1]);
  }
  Record read = Part(record, 0, force.size());
  read.force = std::move(force);
  return {read, AllOf(driven.law)};
}

/// A hysteresis of readings, −1 … 1: a play's that slips over a fifth of their half range.
std::vector<double> HysteresisOf(const std::vector<double>& readings, double half_range) {
  const double play = half_range / 10;
  std::vector<double> hysteresis;
  double middle = readings.front();
  for (const double reading : readings) {
    middle = std::clamp(middle, reading - play, reading + play);
    hysteresis.push_back((reading - middle) / play);
  }
  return hysteresis;
}

/// A reading that comes after its quantity: stiffer at once after each turn.
Loop DisplacementHysteresis(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double half_width = At(level, {0.005, 0.02, 0.08}) * Amplitude(truth);
  const std::vector<double> hysteresis = HysteresisOf(record.displacement, Amplitude(truth));
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.displacement[i] -= half_width * hysteresis[i];
  }
  Expected expected = AllOf(truth.law);
  expected.sigma.reset();
  return {record, expected};
}

Loop ForceHysteresis(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const double half_width = At(level, {0.005, 0.02, 0.08}) * truth.law.slip_force;
  const std::vector<double> hysteresis = HysteresisOf(record.force, truth.law.slip_force);
  for (std::size_t i = 0; i < record.size(); ++i) record.force[i] += half_width * hysteresis[i];
  Expected expected = AllOf(truth.law);
  expected.sigma->highest *= 1 + At(level, {0.05, 0.2, 0.8});
  expected.slip_force->highest += half_width;
  return {record, expected};
}

}  // namespace

std::vector<Kind> ChannelKinds() {
  return {
      {"force lags", Half::kDevelopment, ForceLags, "1, 3, 6 samples"},
      {"displacement lags", Half::kHeldOut, DisplacementLags, "1, 3, 6 samples"},
      {"force saturates", Half::kDevelopment, ForceSaturates,
       "at 98, 90, 70 % of Tc, on one side or both"},
      {"gain drifts", Half::kHeldOut, GainDrifts,
       "1, 5, 20 % over the record; sigma and Tc may be any between first and last"},
      {"offset drifts", Half::kDevelopment, OffsetDrifts, "2, 10, 40 % of Tc over the record"},
      {"temperature moves the displacement sensor", Half::kHeldOut, TemperatureDrifts,
       "2, 10, 40 % of X over the record, ever slower"},
      {"low-pass filter of the force", Half::kDevelopment, ForceLowPass,
       "first order, time constant 1, 3, 8 samples"},
      {"smoothed force", Half::kHeldOut, ForceSmoothed, "mean of 5, 15, 41 samples"},
      {"dead band of the displacement sensor", Half::kDevelopment, DeadBand,
       "0.5, 2, 8 % of X to either side"},
      {"cross-talk of displacement on force", Half::kHeldOut, CrossTalkOnForce,
       "2, 10, 30 % of Tc at X, of either sign"},
      {"cross-talk of force on displacement", Half::kDevelopment, CrossTalkOnDisplacement,
       "2, 10, 30 % of Tc/sigma against the motion; asked are the apparent stiffness and Tc"},
      {"curved displacement sensor", Half::kHeldOut, CurvedDisplacement,
       "cubic, 1, 5, 20 % at X; sigma, of which the gain is part, is not asked"},
      {"clock of the force is fast", Half::kHeldOut, ForceClockIsFast,
       "by 0.05, 0.1, 0.2 %, over eight cycles", false},
      {"hysteresis of the displacement sensor", Half::kHeldOut, DisplacementHysteresis,
       "0.5, 2, 8 % of X; sigma is not asked", false},
      {"hysteresis of the force sensor", Half::kHeldOut, ForceHysteresis,
       "0.5, 2, 8 % of Tc; Tc and sigma may be with or without it", false},
  };
}

}  // namespace mindahl::reliability
