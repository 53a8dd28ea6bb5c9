#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "core/extremes.h"
#include "loop/rules.h"
#include "loop/statistics.h"
#include "loop/strokes.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {
std::vector<std::size_t> TurningPoints(std::span<const double> displacement,
                                       std::span<const std::size_t> reversals) {
  std::vector<std::size_t> points;
  points.reserve(reversals.size() + 2);
  points.assign(reversals.begin(), reversals.end());
  if (points.empty()) return points;
  const auto [lowest, highest] = ExtremesOf(displacement);
  const double tolerance = CycleRules::kAtExtreme * (highest - lowest);
  const auto at_extreme = [&](std::size_t end, std::size_t neighbour) {
    const bool upper = displacement[end] > displacement[neighbour];
    return upper ? highest - displacement[end] <= tolerance
                 : displacement[end] - lowest <= tolerance;
  };
  const std::size_t last = displacement.size() - 1;
  if (points.front() != 0 && at_extreme(0, points.front())) points.insert(points.begin(), 0);
  if (points.back() != last && at_extreme(last, reversals.back())) points.push_back(last);
  return points;
}

std::pair<double, double> MovingMeanRange(std::span<const double> force) {
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

double CycleEnergy(const RecordView& record, std::size_t first, std::size_t last) {
  const std::span<const double> x = record.displacement;
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
  if (!(std::abs(energy) <= static_cast<long double>(std::numeric_limits<double>::max()))) {
    ThrowInvalid("energy of a cycle [J]", std::numeric_limits<double>::infinity(),
                 "must be within the range of double, 1.8e308: use larger units");
  }
  return static_cast<double>(energy);
}

namespace {

/// Swings between turning points, with the record's ends as fractions of one.
double CountSwings(std::span<const double> displacement, std::span<const std::size_t> points,
                   double amplitude) {
  const double head = std::abs(displacement[points.front()] - displacement.front());
  const double tail = std::abs(displacement.back() - displacement[points.back()]);
  return static_cast<double>(points.size() - 1) + (head + tail) / (2 * amplitude);
}

/// Returns the strokes that reach as far as the widest, to a twentieth: not nested loops, run-in or
/// run-out. Without two turning points the whole record is one.
std::vector<Stroke> MainStrokes(const RecordView& record, std::span<const std::size_t> points) {
  if (points.size() < 2) return {StrokeOf(record, 0, record.size() - 1)};
  std::vector<Stroke> strokes;
  strokes.reserve(points.size());
  double widest = 0.0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    strokes.push_back(StrokeOf(record, points[k], points[k + 1]));
    widest = std::max(widest, strokes.back().range());
  }
  std::erase_if(
      strokes, [&](const Stroke& stroke) { return stroke.range() < CycleRules::kSteady * widest; });
  return strokes;
}

template <typename Quantity>
double MeanOf(std::span<const Stroke> strokes, Quantity quantity) {
  double sum = 0.0;
  for (const Stroke& stroke : strokes) sum += quantity(stroke);
  return sum / static_cast<double>(strokes.size());
}

/// Returns the typical extreme of the strokes of one direction, the larger by `compare` of the two
/// directions. Medians: a spike in one stroke must not make the peak force.
template <typename Quantity, typename Compare>
double UsualExtreme(std::span<const Stroke> strokes, Quantity quantity, Compare compare) {
  std::array<std::vector<double>, 2> of;
  for (const Stroke& stroke : strokes) of[stroke.rises() ? 0 : 1].push_back(quantity(stroke));
  if (of[0].empty()) return Median(of[1]);
  if (of[1].empty()) return Median(of[0]);
  return std::max(Median(of[0]), Median(of[1]), compare);
}

int SignOf(double value) { return (value > 0) - (value < 0); }

/// Returns Σ((v[i+1] − v[i−1])/2)², by which noise of the other channel enters ∮F dx.
double SquaredSteps(std::span<const double> values) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double step = (values[i + 1] - values[i - 1]) / 2;
    sum += step * step;
  }
  return sum;
}

/// Returns the standard deviation of the mean energy of closed cycles that noise of both channels
/// makes.
double NoiseOfMeanEnergy(const RecordView& record, std::size_t cycles) {
  const double of_force =
      NoiseByDifferences(record.force, 2) * std::sqrt(SquaredSteps(record.displacement));
  const double of_displacement =
      NoiseByDifferences(record.displacement, 2) * std::sqrt(SquaredSteps(record.force));
  return std::hypot(of_force, of_displacement) / static_cast<double>(cycles);
}

}  // namespace

std::vector<double> CycleEnergies(const RecordView& record,
                                  std::span<const std::size_t> reversals) {
  std::vector<double> energies;
  const std::vector<std::size_t> points = TurningPoints(record.displacement, reversals);
  energies.reserve(points.size());
  for (std::size_t k = 0; k + 2 < points.size(); k += 2) {
    energies.push_back(CycleEnergy(record, points[k], points[k + 2]));
  }
  return energies;
}

LoopMeasures MeasureLoop(const RecordView& record, std::span<const std::size_t> reversals) {
  const std::span<const double> x = record.displacement;
  LoopMeasures measures;
  const std::vector<std::size_t> points = TurningPoints(x, reversals);
  const std::vector<Stroke> strokes = MainStrokes(record, points);
  measures.amplitude = MeanOf(strokes, [](const Stroke& of) { return of.range(); }) / 2;
  // Most loops peak where they turn; some before, when the force relaxes in a dwell.
  const double lower_end = MeanOf(strokes, [](const Stroke& of) { return of.lower_end_force(); });
  const double upper_end = MeanOf(strokes, [](const Stroke& of) { return of.upper_end_force(); });
  const auto least = [](const Stroke& of) { return MovingMeanRange(of.force).first; };
  const auto greatest = [](const Stroke& of) { return MovingMeanRange(of.force).second; };
  const double greatest_force =
      std::max({lower_end, upper_end, UsualExtreme(strokes, greatest, std::less<>())});
  const double least_force =
      std::min({lower_end, upper_end, UsualExtreme(strokes, least, std::greater<>())});
  measures.peak_force = (greatest_force - least_force) / 2;

  if (!reversals.empty() && measures.amplitude > 0) {
    measures.cycles = static_cast<std::size_t>(CountSwings(x, points, measures.amplitude) / 2 +
                                               CycleRules::kAtExtreme);
  }
  return measures;
}

int ForceSense(const RecordView& record, std::span<const std::size_t> reversals) {
  const Extremes displacement = ExtremesOf(record.displacement);
  const Extremes force = ExtremesOf(record.force);
  const double rectangle =
      (displacement.greatest - displacement.least) * (force.greatest - force.least);
  const std::vector<double> energies = CycleEnergies(record, reversals);
  if (!energies.empty() && std::abs(Mean(energies)) > CycleRules::kThin * rectangle &&
      std::abs(Mean(energies)) >
          CycleRules::kDeviations * NoiseOfMeanEnergy(record, energies.size())) {
    return SignOf(Mean(energies));
  }
  const double mean_displacement = Mean(record.displacement);
  const double mean_force = Mean(record.force);
  double covariance = 0.0;
  for (std::size_t i = 0; i < record.size(); ++i) {
    covariance += (record.displacement[i] - mean_displacement) * (record.force[i] - mean_force);
  }
  return SignOf(covariance);
}

}  // namespace mindahl::loop
