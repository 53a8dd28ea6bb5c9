#include "mindahl/loop/facts.h"

#include <algorithm>
#include <array>
#include <boost/math/statistics/bivariate_statistics.hpp>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "core/extremes.h"
#include "core/refuse.h"
#include "loop/statistics.h"

namespace mindahl::loop {
namespace {

using Column = std::span<const double>;

/// [of the range] Farthest from an extreme that an end of a record is a turning point; [cycles]
/// the most that one which counts is short of a whole one.
constexpr double kAtExtreme = 0.02;
/// [of the widest cycle's amplitude] Least amplitude of a cycle that is one of the widest.
constexpr double kSteady = 0.95;

/// Returns the reversals, with the record's first and last sample where they lie at an extreme. The
/// first one is left out if the first cycle does not return to its force: the contact was unloaded.
std::vector<std::size_t> TurningPoints(const RecordView& record,
                                       std::span<const std::size_t> reversals) {
  std::vector<std::size_t> points(reversals.begin(), reversals.end());
  if (points.empty()) return points;
  const Column x = record.displacement;
  const auto [lowest, highest] = ExtremesOf(x);
  const auto at_extreme = [&](std::size_t end, std::size_t neighbour) {
    const double extreme = x[end] > x[neighbour] ? highest : lowest;
    return std::abs(extreme - x[end]) <= kAtExtreme * (highest - lowest);
  };
  const std::size_t last = x.size() - 1;
  if (points.back() != last && at_extreme(last, points.back())) points.push_back(last);
  const auto [least, greatest] = ExtremesOf(record.force);
  const double way = points.size() < 2 ? 0.0 : record.force[points[1]] - record.force[0];
  const bool comes_back = std::abs(way) <= 0.2 * (greatest - least);
  if (points.front() != 0 && comes_back && at_extreme(0, points.front())) {
    points.insert(points.begin(), 0);
  }
  return points;
}

/// Returns the least and greatest mean over a twentieth of the samples: what a stroke's force keeps
/// to, not its noise.
Extremes MovingMeanRange(Column force) {
  const std::size_t width = std::max<std::size_t>(force.size() / 20, 1);
  double sum =
      std::accumulate(force.begin(), force.begin() + static_cast<std::ptrdiff_t>(width), 0.0);
  double least = sum;
  double greatest = sum;
  for (std::size_t i = width; i < force.size(); ++i) {
    sum += force[i] - force[i - width];
    least = std::min(least, sum);
    greatest = std::max(greatest, sum);
  }
  return {least / static_cast<double>(width), greatest / static_cast<double>(width)};
}

/// The samples from one turning point to the next.
struct Stroke {
  Column displacement;  // [m]
  Column force;         // [N]

  [[nodiscard]] bool rises() const { return displacement.back() > displacement.front(); }
  [[nodiscard]] double travel() const {
    return std::abs(displacement.back() - displacement.front());
  }
};

/// Means of y over ranges of x that follow on each other, `edges` from the lowest: of a line from
/// sample to sample ∫ y dx by trapezia, to and fro, over each range. Empty where the line does not
/// cross one of them once in all.
template <std::size_t kEdges>
std::optional<std::array<double, kEdges - 1>> MeansBetween(
    Column x, Column y, const std::array<double, kEdges>& edges) {
  constexpr double kWhole = 1e-6;
  constexpr std::size_t kParts = kEdges - 1;
  std::array<double, kParts> integrals{};
  std::array<double, kParts> ways{};
  std::size_t first = 0;  // part that the lower end of the step lies in, or the nearest
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double step = x[i] - x[i - 1];
    const auto [lowest, highest] = std::minmax(x[i - 1], x[i]);
    if (highest <= edges.front() || lowest >= edges.back()) continue;
    while (first > 0 && lowest < edges[first]) --first;
    while (first + 1 < kParts && lowest >= edges[first + 1]) ++first;
    if (lowest >= edges[first] && highest <= edges[first + 1]) {  // most lie within one
      integrals[first] += (y[i - 1] + y[i]) / 2 * step;
      ways[first] += step;
      continue;
    }
    for (std::size_t j = first; j < kParts && highest > edges[j]; ++j) {
      const double from = std::clamp(x[i - 1], edges[j], edges[j + 1]);
      const double to = std::clamp(x[i], edges[j], edges[j + 1]);
      if (from == to) continue;
      const double slope = (y[i] - y[i - 1]) / step;
      const double middle = y[i - 1] + slope * ((from + to) / 2 - x[i - 1]);
      integrals[j] += middle * (to - from);
      ways[j] += to - from;
    }
  }
  for (std::size_t j = 0; j < kParts; ++j) {
    if (!(std::abs(ways[j]) > (1 - kWhole) * (edges[j + 1] - edges[j]))) return std::nullopt;
    integrals[j] /= ways[j];
  }
  return integrals;
}

/// The two strokes of a cycle in order of time.
struct Cycle {
  Stroke first;
  Stroke second;

  [[nodiscard]] const Stroke& rising() const { return first.rises() ? first : second; }
  [[nodiscard]] const Stroke& falling() const { return first.rises() ? second : first; }
};

/// Means of the forces of the rising and the falling stroke over equal parts of the middle fraction
/// of what both pass, from the lowest; empty where two strokes between turns of the force have no
/// displacement in common.
template <std::size_t kParts>
std::optional<std::array<std::array<double, kParts>, 2>> PartsOf(const Cycle& cycle,
                                                                 double fraction) {
  const Column up = cycle.rising().displacement;
  const Column down = cycle.falling().displacement;
  const Extremes both = {std::max(up.front(), down.back()), std::min(up.back(), down.front())};
  const double reach = fraction * both.half_range();
  if (!(reach > 0)) return std::nullopt;
  std::array<double, kParts + 1> edges{};
  for (std::size_t j = 0; j <= kParts; ++j) {
    edges[j] =
        both.middle() - reach + 2 * reach * static_cast<double>(j) / static_cast<double>(kParts);
  }
  const auto rising = MeansBetween(up, cycle.rising().force, edges);
  const auto falling = MeansBetween(down, cycle.falling().force, edges);
  if (!rising || !falling) return std::nullopt;
  return {{*rising, *falling}};
}

/// Measures the gap between the strokes and, where there is one, how far the contact slides.
void MeasureGap(const Cycle& cycle, CycleFacts& facts) {
  constexpr double kMiddle = 1.0 / 3;  // of the stroke
  constexpr double kAbout = 0.1;       // of T*
  auto parts = PartsOf<5>(cycle, kMiddle);
  if (!parts) return;
  auto& [up, down] = *parts;
  auto gaps = up;
  std::ranges::transform(up, down, gaps.begin(), std::minus<>());
  facts.half_gap = Median(gaps) / 2;
  facts.centre_force = (Median(up) + Median(down)) / 2;
  if (!(facts.peak_force > 0)) return;
  const std::array edges = {*facts.centre_force - kAbout * facts.peak_force,
                            *facts.centre_force + kAbout * facts.peak_force};
  const auto sliding_back =
      MeansBetween(cycle.falling().force, cycle.falling().displacement, edges);
  const auto sliding_on = MeansBetween(cycle.rising().force, cycle.rising().displacement, edges);
  if (sliding_back && sliding_on) {
    facts.sliding_amplitude = (sliding_back->front() - sliding_on->front()) / 2;
  }
}

CycleFacts MeasureCycle(const RecordView& record, std::size_t begin, std::size_t end,
                        const Cycle& cycle) {
  CycleFacts facts;
  facts.start = begin;
  facts.amplitude = cycle.first.travel() / 4 + cycle.second.travel() / 4;
  const Column one = cycle.first.force;
  const Column other = cycle.second.force;
  const auto [one_least, one_greatest] = MovingMeanRange(one);
  const auto [other_least, other_greatest] = MovingMeanRange(other);
  const auto [least, greatest] = std::minmax({one_least, other_least, one_greatest, other_greatest,
                                              one.back(), (one.front() + other.back()) / 2});
  facts.peak_force = (greatest - least) / 2;
  facts.energy = CycleEnergy(record, begin, end);
  const double rectangle = 4 * facts.amplitude * facts.peak_force;
  if (rectangle > 0) facts.energy_ratio = facts.energy / rectangle;
  MeasureGap(cycle, facts);
  return facts;
}

double StandardDeviation(Column values) {
  return std::sqrt(boost::math::statistics::sample_variance(values.begin(), values.end()));
}

std::optional<double> Asymmetry(std::span<const Cycle> cycles, const LoopFacts& facts) {
  constexpr std::size_t kParts = 10;
  constexpr double kReach = 0.95;  // of what both strokes pass: their corners differ in a sample
  std::array<double, kParts> sums{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < cycles.size(); ++k) {
    if (!facts.cycles[k].steady) continue;
    const auto parts = PartsOf<kParts>(cycles[k], kReach);
    if (!parts) continue;
    const auto& [up, down] = *parts;
    for (std::size_t j = 0; j < kParts; ++j) sums[j] += up[j] + down[kParts - 1 - j];
    ++count;
  }
  if (count == 0 || !(facts.peak_force > 0)) return std::nullopt;
  for (double& sum : sums) sum /= 2 * static_cast<double>(count);
  return StandardDeviation(sums) / facts.peak_force;
}

/// Measures what a record shows whether it closes a cycle or not.
void MeasureStrokes(const RecordView& record, std::span<const std::size_t> points,
                    LoopFacts& facts) {
  const Column x = record.displacement;
  std::vector<double> travels;
  for (std::size_t k = 1; k < points.size(); ++k) {
    travels.push_back(std::abs(x[points[k]] - x[points[k - 1]]));
  }
  const auto [lowest, highest] = ExtremesOf(x);
  if (travels.empty()) travels.push_back(highest - lowest);
  const double widest = std::ranges::max(travels);
  std::erase_if(travels, [&](double travel) { return travel < kSteady * widest; });
  facts.amplitude = Mean(travels) / 2;
  auto [least, greatest] = MovingMeanRange(record.force);
  std::vector<std::size_t> turns(points.begin(), points.end());
  turns.insert(turns.end(), {0, x.size() - 1});
  for (const std::size_t turn : turns) {
    least = std::min(least, record.force[turn]);
    greatest = std::max(greatest, record.force[turn]);
  }
  facts.peak_force = (greatest - least) / 2;
  if (points.empty() || !(facts.amplitude > 0)) return;
  const double ends =
      std::abs(x[points.front()] - x.front()) + std::abs(x.back() - x[points.back()]);
  const double swings = static_cast<double>(points.size() - 1) + ends / (2 * facts.amplitude);
  facts.complete_cycles = static_cast<std::size_t>(swings / 2 + kAtExtreme);
}

}  // namespace

bool HasEvenGap(const LoopFacts& facts) {
  constexpr double kUneven = 0.1;
  if (!facts.closed || !facts.half_gap || !(*facts.half_gap > 0)) return false;
  const double even = facts.energy_per_cycle / (4 * facts.amplitude * *facts.half_gap);
  return std::abs(even - 1) < kUneven;
}

bool Slides(const LoopFacts& facts) {
  // [W/(4XT*)] Mindlin's contact has it at twice its gross-slip displacement, beyond which the gap
  // at mid-stroke is that of the slip force.
  constexpr double kEnergyRatio = 0.6;
  constexpr double kGap = 0.5;  // [T*] less is no plateau: the strokes were not separated
  const bool has_gap = facts.half_gap && *facts.half_gap > kGap * facts.peak_force;
  // A spring parallel to the contact raises T*, and neither the energy nor the gap.
  return facts.closed && has_gap && (facts.energy_ratio >= kEnergyRatio || HasEvenGap(facts));
}

bool HasSlipped(const LoopFacts& facts) {
  if (Slides(facts)) return true;
  if (!facts.closed || !facts.sliding_amplitude || !(*facts.sliding_amplitude > 0)) return false;
  return facts.energy_per_cycle >= 0.85 * 4 * facts.peak_force * *facts.sliding_amplitude;
}

double CycleEnergy(const RecordView& record, std::size_t first, std::size_t last) {
  const Column x = record.displacement;
  // Forces relative to the first sample: an offset must not cost digits on a small loop.
  const auto force = [&](std::size_t i) {
    return static_cast<long double>(record.force[i]) - record.force[first];
  };
  const auto way = [&](std::size_t from, std::size_t to) {
    return static_cast<long double>(x[to]) - x[from];
  };
  long double energy = 0.5L * force(last) * way(last, first);
  for (std::size_t i = first + 1; i <= last; ++i) {
    energy += 0.5L * (force(i) + force(i - 1)) * way(i - 1, i);
  }
  return Representable("energy of a cycle [J]", energy);
}

LoopFacts MeasureFacts(const RecordView& record, std::span<const std::size_t> reversals,
                       int force_sense, std::span<const unsigned char> counts) {
  Validate(record);
  if (record.size() == 0) throw InvalidArgument("the record is empty: must have samples");
  if (std::abs(force_sense) != 1) ThrowInvalid("force sign [-]", force_sense, "must be +1 or -1");
  LoopFacts facts;
  std::vector<Cycle> cycles;
  const std::vector<std::size_t> points = TurningPoints(record, reversals);
  MeasureStrokes(record, points, facts);
  const auto stroke = [&](std::size_t begin, std::size_t end) {
    return Stroke{record.displacement.subspan(begin, end - begin + 1),
                  record.force.subspan(begin, end - begin + 1)};
  };
  for (std::size_t k = 0; k + 2 < points.size(); k += 2) {
    const std::size_t begin = points[k];
    const std::size_t end = points[k + 2];
    cycles.push_back({stroke(begin, points[k + 1]), stroke(points[k + 1], end)});
    CycleFacts& cycle = facts.cycles.emplace_back(MeasureCycle(record, begin, end, cycles.back()));
    const auto samples = counts.empty() ? counts : counts.subspan(begin, end - begin);
    cycle.steady = 2 * std::ranges::count(samples, 1) > std::ssize(samples);
  }
  facts.closed = !facts.cycles.empty();
  if (!facts.closed) return facts;
  if (std::ranges::none_of(facts.cycles, &CycleFacts::steady)) {
    for (CycleFacts& cycle : facts.cycles) cycle.steady = true;
  }
  // Returns the values of the steady cycles that have the fact.
  const auto values_of = [&](auto fact) {
    std::vector<double> values;
    for (const CycleFacts& cycle : facts.cycles) {
      const std::optional<double> value = cycle.*fact;
      if (cycle.steady && value) values.push_back(*value);
    }
    return values;
  };
  const double widest = std::ranges::max(values_of(&CycleFacts::amplitude));
  for (CycleFacts& cycle : facts.cycles) {
    cycle.steady = cycle.steady && cycle.amplitude >= kSteady * widest;
  }
  const std::vector<double> amplitudes = values_of(&CycleFacts::amplitude);
  facts.steady_cycles = amplitudes.size();
  facts.amplitude = Mean(amplitudes);
  facts.peak_force = Median(values_of(&CycleFacts::peak_force));
  facts.energy_per_cycle = Mean(values_of(&CycleFacts::energy));
  facts.energy_ratio = Mean(values_of(&CycleFacts::energy_ratio));
  facts.asymmetry = Asymmetry(cycles, facts);
  const std::vector<double> sliding = values_of(&CycleFacts::sliding_amplitude);
  if (!sliding.empty()) facts.sliding_amplitude = Mean(sliding);
  const std::vector<double> gaps = values_of(&CycleFacts::half_gap);
  if (!gaps.empty()) facts.half_gap = Mean(gaps);
  if (gaps.size() > 1) facts.half_gap_standard_deviation = StandardDeviation(gaps);
  if (force_sense < 0) TurnForce(facts);
  return facts;
}

void TurnForce(LoopFacts& facts) {
  const auto turn = [](std::optional<double>& value) {
    if (value) *value = -*value;
  };
  for (CycleFacts& cycle : facts.cycles) {
    cycle.energy = -cycle.energy;
    cycle.energy_ratio = -cycle.energy_ratio;
    turn(cycle.half_gap);
    turn(cycle.centre_force);
  }
  facts.energy_per_cycle = -facts.energy_per_cycle;
  facts.energy_ratio = -facts.energy_ratio;
  turn(facts.half_gap);
}

int ForceSense(const RecordView& record, const LoopFacts& facts) {
  constexpr double kThin = 0.01;           // of the rectangle round the loop
  constexpr double kSureDeviations = 5.0;  // one record in 3.5 million
  const auto sign_of = [](double value) { return (value > 0) - (value < 0); };
  // The noise of a channel enters ∮F dx by Σ((v[i+1] − v[i−1])/2)² of the other one.
  const auto noise_of = [](Column noisy, Column other) {
    double sum = 0.0;
    for (std::size_t i = 1; i + 1 < other.size(); ++i) {
      const double step = (other[i + 1] - other[i - 1]) / 2;
      sum += step * step;
    }
    return NoiseByDifferences(noisy, 2) * std::sqrt(sum);
  };
  const Extremes displacement = ExtremesOf(record.displacement);
  const Extremes force = ExtremesOf(record.force);
  const auto cycles = static_cast<double>(facts.cycles.size());
  const double rectangles =
      cycles * (displacement.greatest - displacement.least) * (force.greatest - force.least);
  double energies = 0.0;
  for (const CycleFacts& cycle : facts.cycles) energies += cycle.energy;
  if (std::abs(energies) > kThin * rectangles &&
      std::abs(energies) >
          kSureDeviations * std::hypot(noise_of(record.force, record.displacement),
                                       noise_of(record.displacement, record.force))) {
    return sign_of(energies);
  }
  return sign_of(boost::math::statistics::covariance(record.displacement, record.force));
}

}  // namespace mindahl::loop
