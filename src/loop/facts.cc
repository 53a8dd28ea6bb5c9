#include "mindahl/loop/facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "loop/rules.h"
#include "loop/statistics.h"
#include "loop/strokes.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {
namespace {

using Column = std::span<const double>;

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

/// Means of a stroke's force over equal parts of [centre − reach, centre + reach], from the lowest.
template <std::size_t kParts>
std::optional<std::array<double, kParts>> PartsOf(const Stroke& stroke, double centre,
                                                  double reach) {
  std::array<double, kParts + 1> edges{};
  for (std::size_t j = 0; j <= kParts; ++j) {
    edges[j] = centre - reach + 2 * reach * static_cast<double>(j) / static_cast<double>(kParts);
  }
  return MeansBetween(stroke.displacement, stroke.force, edges);
}

/// The two strokes of a cycle in order of time, with the middle of what both pass.
struct Cycle {
  Stroke first;
  Stroke second;
  double centre = 0.0;  // [m]
  double reach = 0.0;   // [m] to either side

  [[nodiscard]] const Stroke& rising() const { return first.rises() ? first : second; }
  [[nodiscard]] const Stroke& falling() const { return first.rises() ? second : first; }
};

/// @param points  its three turning points
Cycle CycleOf(const RecordView& record, std::span<const std::size_t> points) {
  Cycle cycle{StrokeOf(record, points[0], points[1]), StrokeOf(record, points[1], points[2])};
  const Column up = cycle.rising().displacement;
  const Column down = cycle.falling().displacement;
  const double lower = std::max(up.front(), down.back());
  const double upper = std::min(up.back(), down.front());
  cycle.centre = lower + (upper - lower) / 2;
  cycle.reach = (upper - lower) / 2;
  return cycle;
}

void MeasureGap(const Cycle& cycle, CycleFacts& facts) {
  constexpr std::size_t kParts = 5;
  constexpr double kMiddle = 1.0 / 3;  // of the stroke
  auto up = PartsOf<kParts>(cycle.rising(), cycle.centre, kMiddle * cycle.reach);
  auto down = PartsOf<kParts>(cycle.falling(), cycle.centre, kMiddle * cycle.reach);
  if (!up || !down) return;
  std::array<double, kParts> gaps{};
  std::ranges::transform(*up, *down, gaps.begin(), std::minus<>());
  facts.half_gap = Median(gaps) / 2;
  facts.centre_force = (Median(*up) + Median(*down)) / 2;
}

void MeasureWidth(const Cycle& cycle, CycleFacts& facts) {
  constexpr double kAbout = 0.1;  // of T*
  const std::array edges = {*facts.centre_force - kAbout * facts.peak_force,
                            *facts.centre_force + kAbout * facts.peak_force};
  const auto sliding_back =
      MeansBetween(cycle.falling().force, cycle.falling().displacement, edges);
  const auto sliding_on = MeansBetween(cycle.rising().force, cycle.rising().displacement, edges);
  if (sliding_back && sliding_on) {
    facts.sliding_amplitude = (sliding_back->front() - sliding_on->front()) / 2;
  }
}

double EnergyRatio(double energy, double amplitude, double peak_force) {
  const double rectangle = 4 * amplitude * peak_force;
  return rectangle > 0 ? energy / rectangle : 0.0;
}

double PeakForce(const Cycle& cycle) {
  const Column one = cycle.first.force;
  const Column other = cycle.second.force;
  const auto [one_least, one_greatest] = MovingMeanRange(one);
  const auto [other_least, other_greatest] = MovingMeanRange(other);
  const double ends = (one.front() + other.back()) / 2;
  const double turn = one.back();
  const double greatest = std::max({one_greatest, other_greatest, ends, turn});
  const double least = std::min({one_least, other_least, ends, turn});
  return (greatest - least) / 2;
}

CycleFacts MeasureCycle(const RecordView& record, std::span<const std::size_t> points,
                        const Cycle& cycle) {
  const double way = cycle.second.displacement.back() - cycle.first.displacement.front();
  CycleFacts facts;
  facts.start = points[0];
  facts.amplitude = (cycle.first.travel() + cycle.second.travel()) / 4;
  facts.peak_force = PeakForce(cycle);
  facts.energy = CycleEnergy(record, points[0], points[2]);
  facts.energy_ratio = EnergyRatio(facts.energy, facts.amplitude, facts.peak_force);
  facts.returns = std::abs(way) <= CycleRules::kReturns * 2 * facts.amplitude;
  MeasureGap(cycle, facts);
  if (facts.half_gap && facts.peak_force > 0) MeasureWidth(cycle, facts);
  return facts;
}

double StandardDeviation(Column values) {
  const double mean = Mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

std::optional<double> Asymmetry(std::span<const Cycle> cycles, double peak_force) {
  constexpr std::size_t kParts = 10;
  constexpr double kReach = 0.95;  // of what both strokes pass: their corners differ in a sample
  std::array<double, kParts> sums{};
  std::size_t count = 0;
  for (const Cycle& cycle : cycles) {
    const auto up = PartsOf<kParts>(cycle.rising(), cycle.centre, kReach * cycle.reach);
    const auto down = PartsOf<kParts>(cycle.falling(), cycle.centre, kReach * cycle.reach);
    if (!up || !down) continue;
    for (std::size_t j = 0; j < kParts; ++j) sums[j] += (*up)[j] + (*down)[kParts - 1 - j];
    ++count;
  }
  if (count == 0 || !(peak_force > 0)) return std::nullopt;
  for (double& sum : sums) sum /= 2 * static_cast<double>(count);
  return StandardDeviation(sums) / peak_force;
}

/// Measures forces with the displacement's sign.
LoopFacts MeasureInSense(const RecordView& record, std::span<const std::size_t> reversals) {
  LoopFacts facts;
  std::vector<Cycle> cycles;
  const std::vector<std::size_t> points = TurningPoints(record.displacement, reversals);
  for (std::size_t k = 0; k + 2 < points.size(); k += 2) {
    const auto of_cycle = std::span(points).subspan(k, 3);
    cycles.push_back(CycleOf(record, of_cycle));
    facts.cycles.push_back(MeasureCycle(record, of_cycle, cycles.back()));
  }
  facts.closed = !facts.cycles.empty();
  if (!facts.closed) return facts;
  const double widest = std::ranges::max(facts.cycles, {}, &CycleFacts::amplitude).amplitude;
  std::vector<Cycle> steady;
  for (std::size_t k = 0; k < cycles.size(); ++k) {
    facts.cycles[k].steady = facts.cycles[k].amplitude >= CycleRules::kSteady * widest;
    if (facts.cycles[k].steady) steady.push_back(cycles[k]);
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
  facts.steady_cycles = steady.size();
  facts.amplitude = Mean(values_of(&CycleFacts::amplitude));
  facts.peak_force = Mean(values_of(&CycleFacts::peak_force));
  facts.energy_per_cycle = Mean(values_of(&CycleFacts::energy));
  facts.energy_ratio = EnergyRatio(facts.energy_per_cycle, facts.amplitude, facts.peak_force);
  facts.asymmetry = Asymmetry(steady, facts.peak_force);
  const std::vector<double> sliding = values_of(&CycleFacts::sliding_amplitude);
  if (!sliding.empty()) facts.sliding_amplitude = Mean(sliding);
  const std::vector<double> gaps = values_of(&CycleFacts::half_gap);
  if (!gaps.empty()) facts.half_gap = Mean(gaps);
  if (gaps.size() > 1) facts.half_gap_standard_deviation = StandardDeviation(gaps);
  return facts;
}

}  // namespace

bool Slides(const LoopFacts& facts) {
  const bool has_gap = facts.half_gap && *facts.half_gap > SlidingRules::kGap * facts.peak_force;
  if (!facts.closed || !has_gap) return false;
  // A spring parallel to the contact raises T*, and neither the energy nor the gap.
  const double even = facts.energy_per_cycle / (4 * facts.amplitude * *facts.half_gap);
  return facts.energy_ratio >= SlidingRules::kEnergyRatio ||
         std::abs(even - 1) < SlidingRules::kUneven;
}

bool RanAway(const LoopFacts& facts, double slip_force) {
  constexpr double kFarthest = 1.25;
  if (!Slides(facts)) return false;
  const double ratio = slip_force / std::abs(*facts.half_gap);
  return !(ratio <= kFarthest && ratio >= 1 / kFarthest);
}

bool ReachesSlip(const LoopFacts& facts) {
  if (!facts.closed || !facts.sliding_amplitude || !(*facts.sliding_amplitude > 0)) return false;
  const double rectangle = 4 * facts.peak_force * *facts.sliding_amplitude;
  return facts.energy_per_cycle >= SlidingRules::kFull * rectangle;
}

LoopFacts MeasureFacts(const RecordView& record, std::span<const std::size_t> reversals,
                       int force_sense) {
  Validate(record);
  if (record.size() == 0) throw InvalidArgument("the record is empty: must have samples");
  if (force_sense == 1) return MeasureInSense(record, reversals);
  if (force_sense != -1) ThrowInvalid("force sign [-]", force_sense, "must be +1 or -1");
  std::vector<double> turned(record.force.begin(), record.force.end());
  for (double& force : turned) force = -force;
  RecordView in_sense = record;
  in_sense.force = turned;
  return MeasureInSense(in_sense, reversals);
}

LoopFacts MeasureFacts(const PreparedRecord& prepared, int force_sense) {
  RecordView record = prepared.readings();
  record.displacement = prepared.displacement();
  return MeasureFacts(record, prepared.reversals, force_sense);
}

}  // namespace mindahl::loop
