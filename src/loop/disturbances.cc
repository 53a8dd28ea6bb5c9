#include "mindahl/loop/disturbances.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "core/extremes.h"
#include "loop/statistics.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {

namespace {

/// Returns the distances between neighbours that differ.
std::vector<double> StepsOf(std::span<const double> values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = std::abs(values[i] - values[i - 1]);
    if (step > 0) steps.push_back(step);
  }
  return steps;
}

/// True if nearly all neighbours differ by whole steps, and either by four or more numbers of steps
/// that keep changing, or after rests of different lengths. A drive of constant speeds, sampled
/// evenly, also gives whole steps.
bool IsQuantised(std::span<const double> displacement, double step, bool rests_at_turns) {
  constexpr std::size_t kSpeeds = 4;
  constexpr std::size_t kHeld = 10;  // samples, on average, for which a drive holds its speeds
  constexpr double kWhole = 1e-6;
  constexpr double kMostBroken = 0.01;  // of the pairs
  // Multiples of a finer step are no more whole than rounding leaves them, nor any reading's.
  constexpr double kFinest = 1e-9;
  const auto [lowest, highest] = ExtremesOf(displacement);
  if (!(step > kFinest * (highest - lowest))) return false;
  auto broken = kMostBroken * static_cast<double>(displacement.size() - 1);  // that are left
  std::size_t rest = 1;                                                      // samples
  double last = 0.0;  // steps of the last motion
  std::set<std::size_t> rests;
  std::set<double> speeds;
  std::size_t changes = 0;
  for (std::size_t i = 1; i < displacement.size(); ++i) {
    const double steps = (displacement[i] - displacement[i - 1]) / step;
    const double nearest = std::round(steps);
    if (!(std::abs(steps - nearest) < kWhole) && --broken < 0) return false;
    if (nearest == 0) {
      ++rest;
      continue;
    }
    if (last != 0 && (rests_at_turns || last * nearest > 0)) rests.insert(rest);
    if (speeds.size() < kSpeeds) speeds.insert(std::abs(nearest));
    if (std::abs(nearest) != std::abs(last)) ++changes;
    last = nearest;
    rest = 1;
  }
  return rests.size() > 1 || (speeds.size() == kSpeeds && kHeld * changes > displacement.size());
}

/// Windows that are tried, each about √2 times the last.
constexpr std::array<std::size_t, 15> kReaches = {2,  3,  4,  6,  8,   11,  16, 23,
                                                  32, 45, 64, 91, 128, 181, 256};

/// Weights of 2h + 1 samples whose sum is the value at the middle one, t = 0, of the least-squares
/// parabola through them: a − b·t². Its variance is the noise's times a.
const Eigen::VectorXd& ParabolaWeights(std::size_t reach) {
  static const std::vector<Eigen::VectorXd> weights = [] {
    std::vector<Eigen::VectorXd> of_reaches;
    for (double h = 0; of_reaches.size() <= kReaches.back(); ++h) {
      const double divisor = (2 * h - 1) * (2 * h + 1) * (2 * h + 3);
      const auto samples = static_cast<Eigen::Index>(2 * h + 1);
      of_reaches.emplace_back(
          (3 * (3 * h * h + 3 * h - 1) - 15 * Eigen::ArrayXd::LinSpaced(samples, -h, h).square()) /
          divisor);
    }
    return of_reaches;
  }();
  return weights[reach];
}

double ParabolaAt(std::span<const double> values, std::size_t at, std::size_t reach) {
  const Eigen::VectorXd& weights = ParabolaWeights(reach);
  return weights.dot(Eigen::VectorXd::Map(values.data() + (at - reach), weights.size()));
}

/// Returns half of the widest window about a sample in which parabolas agree.
std::size_t ReachOf(std::span<const double> values, std::size_t at, double noise) {
  constexpr double kDeviations = 2.5;
  const std::size_t room = std::min(at, values.size() - 1 - at);
  double lowest = values[at] - kDeviations * noise;
  double highest = values[at] + kDeviations * noise;
  std::size_t widest = 0;
  for (const std::size_t reach : kReaches) {
    if (reach > room) break;
    const double estimate = ParabolaAt(values, at, reach);
    const double middle = ParabolaWeights(reach)[static_cast<Eigen::Index>(reach)];
    const double deviation = kDeviations * noise * std::sqrt(middle);
    lowest = std::max(lowest, estimate - deviation);
    highest = std::min(highest, estimate + deviation);
    if (!(lowest <= highest)) break;
    widest = reach;
  }
  return widest / 2;
}

}  // namespace

double EncoderStep(std::span<const double> readings, bool rests_at_turns) {
  const std::vector<double> steps = StepsOf(readings);
  if (steps.empty()) return 0.0;
  const double step = std::ranges::min(steps);
  return IsQuantised(readings, step, rests_at_turns) ? step : 0.0;
}

double EstimateDisplacementNoise(std::span<const double> displacement) {
  std::vector<double> anew;  // without repeats
  std::ranges::unique_copy(displacement, std::back_inserter(anew));
  if (anew.size() < 4) return 0.0;
  return std::max(NoiseByDifferences(anew, 3), EncoderStep(displacement) / std::sqrt(12.0));
}

std::vector<std::size_t> SmoothingReaches(std::span<const double> displacement, double noise) {
  RequireNonNegative("displacement noise [m]", noise);
  std::vector<std::size_t> reaches(displacement.size(), 0);
  for (std::size_t i = 0; i < displacement.size() && noise > 0; ++i) {
    reaches[i] = ReachOf(displacement, i, noise);
  }
  return reaches;
}

std::vector<double> Smoothed(std::span<const double> displacement,
                             std::span<const std::size_t> reaches) {
  RequireSameSize("displacement", displacement.size(), "windows", reaches.size());
  std::vector<double> smoothed(displacement.size());
  for (std::size_t i = 0; i < smoothed.size(); ++i) {
    smoothed[i] = ParabolaAt(displacement, i, reaches[i]);
  }
  return smoothed;
}

std::vector<std::size_t> MoveReversals(std::span<const double> smoothed,
                                       std::span<const std::size_t> reversals) {
  std::vector<std::size_t> moved;
  for (std::size_t r = 0; r < reversals.size(); ++r) {
    // From the last turning point, which has moved, to the next, which has not.
    const std::size_t begin = moved.empty() ? 0 : moved.back();
    const std::size_t end = r + 1 < reversals.size() ? reversals[r + 1] : smoothed.size() - 1;
    const auto swing = smoothed.subspan(begin, end - begin + 1);
    const auto outermost = smoothed[reversals[r]] > smoothed[end] ? std::ranges::max_element(swing)
                                                                  : std::ranges::min_element(swing);
    const auto at = static_cast<std::size_t>(outermost - swing.begin());
    if (at > 0) moved.push_back(begin + at);  // else the record begins there
  }
  return moved;
}

namespace {

using Readings = std::span<const double>;

// When a sample is a glitch.

/// [steps about it and of the record] Least height of a spike over both neighbours. Noise of
/// standard deviation s has steps of 2.2 s at the third of 24 and would have to stand out by 6.6.
constexpr double kSpike = 3.0;
/// [samples] Longer ones are as well a pulse of the drive or an inner loop.
constexpr std::size_t kLongestSpike = 3;
/// [samples] The same of a force while the motion goes on in one direction.
constexpr std::size_t kLongestOfForce = 20;
/// [samples] So many to either side of a spike are looked at: the edges of a square wave of six
/// samples a cycle come often enough within them to be distinguished from spikes.
constexpr std::size_t kAboutSpike = 12;
/// [usual steps] Least distance of 0 from the range of a dropout's neighbours.
constexpr double kDropout = 2.0;
/// [of the samples] Largest fraction that may be glitches; more of them are the record.
constexpr double kMost = 0.25;

/// Returns the usual step [unit of the column], which nine tenths of those that are not zero do not
/// exceed; 0 where all are zero.
double UsualStepOf(Readings values) {
  constexpr double kUsualShare = 0.9;
  std::vector<double> steps = StepsOf(values);
  if (steps.empty()) return 0.0;
  const auto at = steps.begin() +
                  static_cast<std::ptrdiff_t>(kUsualShare * static_cast<double>(steps.size() - 1));
  std::ranges::nth_element(steps, at);
  return *at;
}

/// A column with lines over its glitches.
struct Repaired {
  std::vector<double> values{};
  std::set<std::size_t> glitches{};

  [[nodiscard]] double Step(std::size_t i) const { return std::abs(values[i] - values[i - 1]); }
};

/// Draws a line between the samples about [begin, end), which are inside the record.
void LeaveOut(std::size_t begin, std::size_t end, Repaired& channel) {
  const double first = channel.values[begin - 1];
  const double slope = (channel.values[end] - first) / static_cast<double>(end - begin + 1);
  for (std::size_t i = begin; i < end; ++i) {
    channel.glitches.insert(i);
    channel.values[i] = first + slope * static_cast<double>(i - begin + 1);
  }
}

/// Successive samples: [begin, end).
struct Run {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Returns the samples inside the record that read 0 and 0, where some lie off their neighbours: so
/// do the others then, wherever the loop was.
std::vector<Run> FindDropouts(const RecordView& record) {
  const auto is_zero = [&](std::size_t i) {
    return record.displacement[i] == 0 && record.force[i] == 0;
  };
  std::vector<Run> runs;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (!is_zero(i)) continue;
    if (runs.empty() || runs.back().end < i) runs.push_back({i, i});
    runs.back().end = i + 1;
  }
  std::erase_if(runs, [&](const Run& run) { return run.begin == 0 || run.end == record.size(); });
  if (runs.empty()) return runs;
  const auto lies_off = [&](Readings values) {
    std::vector<double> others;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!is_zero(i)) others.push_back(values[i]);
    }
    const double within = kDropout * UsualStepOf(others);
    return std::ranges::any_of(runs, [&](const Run& run) {
      const auto [low, high] = std::minmax(values[run.begin - 1], values[run.end]);
      return std::max(low, -high) > within;
    });
  };
  if (!lies_off(record.displacement) && !lies_off(record.force)) runs.clear();
  return runs;
}

/// Returns the third largest step about [begin, end), that into it and that out of it aside: a
/// second spike makes two. 0 with fewer.
double StepAbout(const Repaired& channel, std::size_t begin, std::size_t end) {
  std::array<double, 3> largest{};
  const std::size_t last = std::min(end + kAboutSpike, channel.values.size() - 1);
  for (std::size_t i = std::max(begin, kAboutSpike + 1) - kAboutSpike; i <= last; ++i) {
    if (i >= begin && i <= end) continue;
    largest[2] = std::max(largest[2], channel.Step(i));
    std::ranges::sort(largest, std::greater<>());
  }
  return largest[2];
}

/// True if a motion goes on in one direction from before [begin, end) to behind it.
bool GoesOn(Readings motion, std::size_t begin, std::size_t end) {
  const auto own = motion.subspan(begin - 2, end + 4 - begin);
  return std::ranges::adjacent_find(own, std::greater_equal()) == own.end() ||
         std::ranges::adjacent_find(own, std::less_equal()) == own.end();
}

/// Returns the number of samples of the spike that begins at i; 0 where none does.
/// @param motion  of a force; empty of a displacement
std::size_t SpikeAt(const Repaired& channel, Readings motion, double usual_step, std::size_t i) {
  const Readings values = channel.values;
  const double sense = values[i] > values[i - 1] ? 1.0 : -1.0;
  const double before = sense * values[i - 1];
  double least = sense * values[i];
  const std::size_t longest = motion.empty() ? kLongestSpike : kLongestOfForce;
  for (std::size_t end = i + 1; end + 1 < values.size() && end <= i + longest; ++end) {
    if (!(least > before)) return 0;
    const double height = least - std::max(before, sense * values[end]);
    if (height > kSpike * channel.Step(end + 1) && height > kSpike * StepAbout(channel, i, end) &&
        height > kSpike * usual_step) {
      return end <= i + kLongestSpike || GoesOn(motion, i, end) ? end - i : 0;
    }
    least = std::min(least, sense * values[end]);
  }
  return 0;
}

/// Makes one pass: a spike may hide another, until it is interpolated.
bool FindSpikes(Readings motion, double usual_step, Repaired& channel) {
  bool found = false;
  for (std::size_t i = 2; i + 2 < channel.values.size(); ++i) {
    // Hardly any step of a clean record exceeds the one before it by this factor.
    if (!(channel.Step(i) > kSpike * channel.Step(i - 1))) continue;
    const std::size_t samples = SpikeAt(channel, motion, usual_step, i);
    if (samples == 0) continue;
    LeaveOut(i, i + samples, channel);
    found = true;
  }
  return found;
}

}  // namespace

Interpolated FindAndInterpolate(const RecordView& record) {
  constexpr int kPasses = 3;
  const std::vector<Run> dropouts = FindDropouts(record);
  const auto repaired = [&](Readings values, Readings motion) {
    Repaired channel{.values = {values.begin(), values.end()}};
    for (const Run& run : dropouts) LeaveOut(run.begin, run.end, channel);
    const double usual_step = UsualStepOf(channel.values);
    for (int pass = 0; pass < kPasses && FindSpikes(motion, usual_step, channel); ++pass) continue;
    const auto count = static_cast<double>(channel.glitches.size());
    const bool is_repaired = count > 0 && count <= kMost * static_cast<double>(values.size());
    return is_repaired ? channel : Repaired();
  };
  Repaired displacement = repaired(record.displacement, {});
  Repaired force = repaired(
      record.force, displacement.values.empty() ? record.displacement : displacement.values);
  displacement.glitches.merge(force.glitches);
  return {std::move(displacement.glitches), std::move(displacement.values),
          std::move(force.values)};
}

}  // namespace mindahl::loop
