#include <algorithm>
#include <cmath>
#include <numbers>

#include "kind.h"
#include "simulation.h"

/// Motions other than a sine of one amplitude. Nothing else is wrong.
namespace mindahl::reliability {
namespace {

using loop::Record;

double Cycles(const Truth& truth, std::size_t least) {
  return static_cast<double>(std::max(truth.cycles, least));
}

Loop Under(const Truth& truth, const Motion& motion, Draws& draws) {
  Record record = Drive(motion, Masing(truth.law));
  AddNoise(record, truth, draws);
  return {record, AllOf(truth.law)};
}

Loop Growing(const Truth& truth, std::size_t level, Draws& draws) {
  return Under(truth,
               Wave(truth, {.waveform = models::Waveform::kGrowingSine,
                            .cycles = Cycles(truth, 3),
                            .growth = At(level, {2, 5, 20})}),
               draws);
}

/// The phase of a drive that goes on at its pace, by its way through the record.
template <typename Displacement>
Motion Along(const Truth& truth, double cycles, Displacement displacement) {
  Motion motion;
  const auto rows = static_cast<std::size_t>(cycles * static_cast<double>(truth.samples_per_cycle));
  for (std::size_t i = 0; i <= rows; ++i) {
    const double phase = static_cast<double>(i) / static_cast<double>(truth.samples_per_cycle);
    motion.time.push_back(phase / truth.frequency);
    motion.displacement.push_back(Amplitude(truth) * displacement(phase));
  }
  return motion;
}

double SineAt(double cycles) { return std::sin(2 * std::numbers::pi * cycles); }

Loop TwoAmplitudes(const Truth& truth, std::size_t level, Draws& draws) {
  const double cycles = 2 * Cycles(truth, 1);
  const double smaller = At(level, {0.7, 0.4, 0.15});
  const Motion motion = Along(truth, cycles, [&](double phase) {
    return (phase < cycles / 2 ? smaller : 1.0) * SineAt(phase);
  });
  return Under(truth, motion, draws);
}

Loop PartialSlip(const Truth& truth, std::size_t level, Draws& draws) {
  Truth partial = truth;
  partial.reach = At(level, {0.6, 0.3, 0.1});
  Loop loop = Under(partial, Sine(partial, draws), draws);
  return loop;
}

/// At each turn the drive rests.
Loop Dwell(const Truth& truth, std::size_t level, Draws& draws) {
  const double rest = At(level, {0.1, 0.3, 0.6});  // of the time
  const Motion motion = Along(truth, Cycles(truth, 1), [&](double phase) {
    const double quarter = phase - 0.25;
    const double within = quarter * 2 - std::floor(quarter * 2);  // of the stroke
    const double stroke = std::floor(quarter * 2);
    const double moved = std::max(0.0, (within - rest) / (1 - rest));
    return phase < 0.25 ? SineAt(phase) : SineAt(0.25 + (stroke + moved) / 2);
  });
  return Under(truth, motion, draws);
}

Loop Triangle(const Truth& truth, std::size_t level, Draws& draws) {
  Truth driven = truth;
  driven.samples_per_cycle = static_cast<std::size_t>(At(level, {200, 60, 22}));
  return Under(driven,
               Wave(driven, {.waveform = models::Waveform::kTriangle, .cycles = Cycles(truth, 2)}),
               draws);
}

Loop Random(const Truth& truth, std::size_t level, Draws& draws) {
  Truth driven = truth;
  driven.samples_per_cycle = static_cast<std::size_t>(At(level, {200, 60, 22}));
  const double cycles = Cycles(truth, 4);
  // Two extremes a cycle, each turning back from the last, the largest that of the amplitude.
  std::vector<double> extremes = {draws.Uniform(-1.0, 1.0)};
  double bound = extremes.front() > 0 ? -1.0 : 1.0;
  double largest = std::abs(extremes.front());
  while (static_cast<double>(extremes.size()) <= 2 * cycles) {
    extremes.push_back(extremes.back() + (bound - extremes.back()) * draws.Uniform(0.0, 1.0));
    largest = std::max(largest, std::abs(extremes.back()));
    bound = -bound;
  }
  const Motion motion = Along(driven, cycles, [&](double phase) {
    const double swings = 2 * phase + 0.5;
    const auto next = static_cast<std::size_t>(swings);
    const double to = extremes[next];
    const double from = next == 0 ? -to : extremes[next - 1];
    const double weight =
        (1 - std::cos(std::numbers::pi * (swings - static_cast<double>(next)))) / 2;
    return std::lerp(from, to, weight) / largest;
  });
  return Under(driven, motion, draws);
}

Loop WanderingMean(const Truth& truth, std::size_t level, Draws& draws) {
  const double cycles = Cycles(truth, 2);
  const double way = At(level, {0.05, 0.20, 0.80});
  const Motion motion =
      Along(truth, cycles, [&](double phase) { return SineAt(phase) + way * phase / cycles; });
  return Under(truth, motion, draws);
}

Loop UnequalStrokes(const Truth& truth, std::size_t level, Draws& draws) {
  const double second = At(level, {0.1, 0.3, 0.6});
  const Motion motion = Along(truth, Cycles(truth, 2), [&](double phase) {
    return SineAt(phase) + second * SineAt(2 * phase + 0.1);
  });
  return Under(truth, motion, draws);
}

}  // namespace

std::vector<Kind> ExcitationKinds() {
  return {
      {"growing amplitude", Half::kHeldOut, Growing, "2, 5, 20 times the first"},
      {"two amplitudes", Half::kDevelopment, TwoAmplitudes, "the first 70, 40, 15 % of the second"},
      {"partial slip", Half::kHeldOut, PartialSlip, "reach 0.6, 0.3, 0.1"},
      {"dwell at the turns", Half::kDevelopment, Dwell, "10, 30, 60 % of the time"},
      {"triangle", Half::kHeldOut, Triangle, "200, 60, 22 samples a cycle"},
      {"random motion", Half::kDevelopment, Random, "200, 60, 22 samples a swing"},
      {"wandering mean", Half::kHeldOut, WanderingMean, "by 5, 20, 80 % of X over the record"},
      {"second harmonic", Half::kDevelopment, UnequalStrokes,
       "10, 30, 60 % of X: strokes within strokes where it is large"},
  };
}

}  // namespace mindahl::reliability
