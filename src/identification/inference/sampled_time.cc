#include "identification/inference/sampled_time.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/least_of.h"
#include "core/probability.h"

namespace mindahl::identification {

Neighbours NeighboursOf(const ScaledRecord& record) {
  Neighbours neighbours;
  std::size_t next = 0;
  bool turned = false;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const bool turns = next < record.reversals.size() && record.reversals[next] == i;
    if (turns) ++next;
    if (!record.inserted.empty() && record.inserted[i] != 0) {
      turned = turns;
      if (turns && !neighbours.samples.empty()) neighbours.turns_after.back() = 1;
      continue;
    }
    neighbours.samples.push_back(i);
    neighbours.turned.push_back(turned ? 1 : 0);
    neighbours.turns_after.push_back(turns ? 1 : 0);
    turned = false;
  }
  return neighbours;
}

bool IsDisplacementHeld(const ScaledRecords& data, std::span<const Neighbours> neighbours) {
  constexpr double kOften = 0.2;  // of the samples: every fifth would be one
  std::size_t repeated = 0;
  std::size_t all = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const auto& samples = neighbours[r].samples;
    for (std::size_t k = 1; k < samples.size(); ++k, ++all) {
      const auto& displacement = data.records[r].displacement;
      if (displacement[samples[k]] == displacement[samples[k - 1]]) ++repeated;
    }
  }
  return static_cast<double>(repeated) > kOften * static_cast<double>(all);
}

Clock ClockOf(const ScaledRecords& data, std::span<const Neighbours> neighbours) {
  Clock clock;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const auto grows = [&](std::size_t one, std::size_t next) {
      return record.time[next] > record.time[one];
    };
    const auto& samples = neighbours[r].samples;
    clock.timed = clock.timed && !record.velocity.empty() &&
                  std::ranges::adjacent_find(samples, std::not_fn(grows)) == samples.end();
  }
  const double first = static_cast<double>(neighbours[0].samples.size()) - 1;
  clock.unit = clock.timed ? data.records[0].units.half_duration : std::max(first, 1.0) / 2;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    std::vector<double>& time = clock.time.emplace_back(record.size());
    const auto& samples = neighbours[r].samples;
    const double middle = (static_cast<double>(samples.size()) - 1) / 2;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const std::size_t i = samples[k];
      time[i] = clock.timed ? record.time[i] * record.units.half_duration / clock.unit
                            : (static_cast<double>(k) - middle) / clock.unit;
    }
  }
  return clock;
}

void Derive(std::span<const double> values, std::span<const double> time,
            const Neighbours& neighbours, bool within_strokes, std::span<double> rate) {
  const auto& samples = neighbours.samples;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const bool looks_back = k > 0 && !(within_strokes && neighbours.turned[k] != 0);
    const bool looks_on =
        k + 1 < samples.size() && !(within_strokes && neighbours.turns_after[k] != 0 && k > 0);
    const std::size_t before = samples[looks_back ? k - 1 : k];
    const std::size_t after = samples[looks_on ? k + 1 : k];
    const double step = time[after] - time[before];
    rate[samples[k]] = step > 0 ? (values[after] - values[before]) / step : 0.0;
  }
}

namespace {

/// Standard deviation of white noise with the median size of the differences of an order: what is
/// smooth leaves little of them.
/// @param weights  binomial coefficients with alternating signs
template <std::size_t kSize>
double DeviationByDifferences(std::span<const double> values,
                              const std::array<double, kSize>& weights) {
  constexpr double kMedianOfNormal = 0.6744897501960817;  // of its size, Φ⁻¹(0.75)
  if (values.size() < 2 * kSize) return std::numeric_limits<double>::infinity();
  double squares = 0.0;
  for (const double weight : weights) squares += weight * weight;
  std::vector<double> differences(values.size() - kSize + 1);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < kSize; ++k) sum += weights[k] * values[i + k];
    differences[i] = std::abs(sum);
  }
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::ranges::nth_element(differences, middle);
  return *middle / (kMedianOfNormal * std::sqrt(squares));
}

/// Returns an upper limit of the noise of readings [their unit]. Sixth differences of a sine of 24
/// samples a cycle are 1e-5 of its amplitude; fourth ones reach less far over a sharp turn.
double LargestNoise(std::span<const double> readings) {
  constexpr std::array kFourth = {1.0, -4.0, 6.0, -4.0, 1.0};
  constexpr std::array kSixth = {1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0};
  return std::min(DeviationByDifferences(readings, kFourth),
                  DeviationByDifferences(readings, kSixth));
}

/// A difference of residuals: its square, and the mean square slope of what it is made of.
struct SlopeDifference {
  double square = 0.0;
  double slope_square = 0.0;
};

/// Second differences within the strokes.
/// @param slope  of every sample of the record
void AddDifferences(const ScaledRecord& record, std::span<const double> slope,
                    std::span<const double> residual, std::vector<SlopeDifference>& differences) {
  const auto turns = [&](std::size_t i) { return std::ranges::binary_search(record.reversals, i); };
  for (std::size_t i = 1; i + 1 < record.size(); ++i) {
    bool is_within = !turns(i) && !turns(i - 1);
    for (std::size_t k = i - 1; k <= i + 1; ++k) {
      is_within = is_within && record.counts[k] != 0 &&
                  (record.inserted.empty() || record.inserted[k] == 0) && std::isfinite(slope[k]);
    }
    if (!is_within) continue;
    const auto square = [](double value) { return value * value; };
    differences.push_back(
        {.square = square(residual[i - 1] - 2 * residual[i] + residual[i + 1]) / 6,
         .slope_square = (square(slope[i - 1]) + 4 * square(slope[i]) + square(slope[i + 1])) / 6});
  }
}

/// −2 ln L of the differences over their number.
double DevianceAt(std::span<const SlopeDifference> differences, double of_force,
                  double of_displacement) {
  double sum = 0.0;
  for (const SlopeDifference& difference : differences) {
    const double variance = of_force + of_displacement * difference.slope_square;
    sum += std::log(variance) + difference.square / variance;
  }
  return sum / static_cast<double>(differences.size());
}

/// The variance of the force's noise that is likeliest with so much of the displacement's for each
/// of its own.
double ForceVarianceAt(std::span<const SlopeDifference> differences, double ratio) {
  double squares = 0.0;
  for (const SlopeDifference& difference : differences) {
    squares += difference.square / (1 + ratio * difference.slope_square);
  }
  return squares / static_cast<double>(differences.size());
}

double ChanceOf(double likelihood_ratio) {
  return PValueOfChiSquared(std::max(likelihood_ratio, 0.0), 1.0);
}

constexpr double kReach = 7.0;  // ln: of the one noise from 1/30 to 30 times the other
constexpr int kPlaces = 8;      // that are tried before the minimum next to the best

}  // namespace

std::optional<SlopeScatter> FindSlopeScatter(const loop::PreparedRecords& prepared,
                                             const Problem& problem, std::span<const double> theta,
                                             std::span<const double> residual, Response& response) {
  const ScaledRecords& data = *problem.data;
  if (data.is_forced() || data.load_varies || problem.parameters.moves_contact())
    return std::nullopt;
  double of_readings = 0.0;  // in units of the data
  for (const loop::PreparedRecord& record : prepared.records) {
    if (record.encoder_step > 0 || record.displacement_noise > 0) return std::nullopt;
    of_readings = std::max(of_readings, LargestNoise(record.readings().displacement) / data.length);
  }
  if (!(of_readings > 0) || !std::isfinite(of_readings)) return std::nullopt;

  response.Bind(problem);
  const LawPoint point = PointAt(problem, theta);
  const double scale = std::exp(LogScaleAt(problem, theta));
  std::vector<SlopeDifference> differences;
  models::OriginSensitivity sensitivity;
  double largest = 0.0;
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    response.DifferentiateByOrigins(point, r, sensitivity);
    std::vector<double> slope(record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
      slope[i] = scale * record.load * record.root_weight[i] * sensitivity.sample_slope[i];
    }
    AddDifferences(record, slope, residual.subspan(begin, record.size()), differences);
    begin += record.size();
  }
  for (const SlopeDifference& difference : differences) {
    largest = std::max(largest, difference.slope_square);
  }
  constexpr std::size_t kFewest = 20;
  if (differences.size() < kFewest || !(largest > 0)) return std::nullopt;
  const double alone = ForceVarianceAt(differences, 0.0);
  // Even where branches are steepest it would be a tenth of the scatter.
  constexpr double kNegligible = 0.1;
  const double at_readings = of_readings * of_readings;
  if (!(alone > 0) || at_readings * largest < kNegligible * alone) return std::nullopt;
  std::vector<Neighbours> neighbours;
  for (const ScaledRecord& record : data.records) neighbours.push_back(NeighboursOf(record));
  if (IsDisplacementHeld(data, neighbours)) return std::nullopt;

  const double middle = -std::log(largest);
  const auto profiled = [&](double log_ratio) {
    const double of_force = ForceVarianceAt(differences, std::exp(log_ratio));
    return DevianceAt(differences, of_force, std::exp(log_ratio) * of_force);
  };
  const double ratio = std::exp(LeastOf(profiled, middle - kReach, middle + kReach, kPlaces));
  const double of_force = ForceVarianceAt(differences, ratio);
  const double least = DevianceAt(differences, of_force, ratio * of_force);
  const auto with_readings = [&](double log_variance) {
    return DevianceAt(differences, std::exp(log_variance), at_readings);
  };
  const double beside = LeastOf(with_readings, std::log(alone) - kReach, std::log(alone) + 1,
                                kPlaces);  // σ_F² beside it
  // Differences that share samples are correlated by −2/3 and 1/6: 1 + 2(4/9 + 1/36).
  constexpr double kSharedSamples = 1.9444444444444444;
  const double count = static_cast<double>(differences.size()) / kSharedSamples;
  return SlopeScatter{
      .deviation = std::sqrt(ratio * of_force) * data.length,
      .p_value = ChanceOf(count * (DevianceAt(differences, alone, 0.0) - least)) / 2,
      .of_readings = of_readings * data.length,
      .p_of_readings = ChanceOf(count * (with_readings(beside) - least))};
}

std::optional<double> NoiseToTry(const SlopeScatter& scatter, bool is_doubted,
                                 const Thresholds& thresholds) {
  // The differences of a few dozen readings are no surer.
  constexpr double kOfReadings = 1.5;
  const double ratio = scatter.deviation / scatter.of_readings;
  if (scatter.p_value < thresholds.slope_scatter && ratio <= kOfReadings) {
    // All of the readings say more of their noise than the few where the loop is steep.
    return ratio > 1 / kOfReadings ? scatter.of_readings : scatter.deviation;
  }
  const bool is_denied = scatter.p_of_readings < thresholds.slope_scatter;
  return is_doubted && !is_denied ? std::optional(scatter.of_readings) : std::nullopt;
}

}  // namespace mindahl::identification
