#include "identification/inference/heavy_tails.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <vector>

#include "core/probability.h"
#include "identification/inference/noise.h"
#include "loop/statistics.h"

namespace mindahl::identification {

namespace {

std::vector<FittedSample> SamplesOf(const Problem& problem, std::span<const double> theta,
                                    std::span<const double> residual, Response& response) {
  std::vector<double> force(problem.size());
  response.Bind(problem);
  response.Evaluate(PointAt(problem, theta), force);
  std::vector<FittedSample> samples;
  samples.reserve(problem.size());
  std::size_t k = 0;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const ScaledRecord& record = problem.data->records[r];
    std::size_t next = 0;
    for (std::size_t i = 0; i < record.size(); ++i, ++k) {
      const bool turns = next < record.reversals.size() && record.reversals[next] == i;
      if (turns) ++next;
      if (!record.inserted.empty() && record.inserted[i] != 0) {
        if (turns && !samples.empty()) samples.back().turns = true;
        continue;
      }
      samples.push_back({.record = r,
                         .response = force[k],
                         .residual = residual[k],
                         .counts = record.counts[i] != 0,
                         .turns = turns});
    }
  }
  return samples;
}

std::vector<double> ResidualsOf(std::span<const FittedSample> samples) {
  std::vector<double> residuals;
  residuals.reserve(samples.size());
  for (const FittedSample& sample : samples) residuals.push_back(sample.residual);
  return residuals;
}

std::size_t CountingSamples(std::span<const FittedSample> samples) {
  return static_cast<std::size_t>(std::ranges::count_if(samples, &FittedSample::counts));
}

/// Returns the sum of squares of a value a sample, of those that count.
double SquaresOf(std::span<const FittedSample> samples, std::span<const double> values) {
  double squares = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].counts) squares += values[i] * values[i];
  }
  return squares;
}

constexpr std::size_t kAlike = 60;  // samples that one width is taken from
constexpr double kFarOff = 6.0;     // of their widths
/// Chance that a reading is so far off: 2e-9 of a normal law whose width is known, and below this
/// of one that 60 samples determine to 15 % (1.17/√60).
constexpr double kChance = 1e-5;
constexpr std::size_t kNearATurn = 3;  // samples, on which a law's own misfit is as narrow

struct Difference {
  std::size_t sample = 0;
  double value = 0.0;  // u
  double steepness = 0.0;
  double width = 0.0;
};

std::vector<Difference> DifferencesOf(std::span<const FittedSample> samples) {
  std::vector<std::size_t> to_turn(samples.size(), samples.size());
  for (std::size_t i = 0, since = samples.size(); i < samples.size(); ++i) {
    const bool begins = i == 0 || samples[i].record != samples[i - 1].record;
    since = samples[i].turns || begins ? 0 : std::min(since + 1, samples.size());
    to_turn[i] = since;
  }
  for (std::size_t k = samples.size(), since = samples.size(); k-- > 0;) {
    const bool ends = k + 1 == samples.size() || samples[k].record != samples[k + 1].record;
    since = samples[k].turns || ends ? 0 : std::min(since + 1, samples.size());
    to_turn[k] = std::min(to_turn[k], since);
  }
  std::vector<Difference> differences;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const FittedSample& before = samples[i - 1];
    const FittedSample& after = samples[i + 1];
    if (to_turn[i] < kNearATurn || !before.counts || !samples[i].counts || !after.counts) continue;
    differences.push_back({i, samples[i].residual - (before.residual + after.residual) / 2,
                           std::abs(after.response - before.response)});
  }
  return differences;
}

/// Each the width of those on which the force is as steep: noise of the displacement is larger on
/// the steep ones.
void FindWidths(std::vector<Difference>& differences) {
  std::vector<std::size_t> order(differences.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return differences[i].steepness; });
  const std::size_t blocks = std::max<std::size_t>(differences.size() / kAlike, 1);
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t begin = b * kAlike;
    const std::size_t end = b + 1 < blocks ? begin + kAlike : order.size();
    std::vector<double> sizes;
    for (std::size_t k = begin; k < end; ++k) {
      sizes.push_back(std::abs(differences[order[k]].value));
    }
    const double width = loop::kDeviationOverMedian * loop::Median(sizes);
    for (std::size_t k = begin; k < end; ++k) differences[order[k]].width = width;
  }
}

}  // namespace

std::optional<HeavyTails> FindHeavyTails(std::span<const FittedSample> samples,
                                         const Evidence& evidence) {
  std::vector<Difference> differences = DifferencesOf(samples);
  if (differences.size() < kAlike) return std::nullopt;
  FindWidths(differences);
  std::size_t count = 0;
  double of_the_off = 0.0;
  for (std::size_t k = 1; k + 1 < differences.size(); ++k) {
    const Difference& here = differences[k];
    const Difference& before = differences[k - 1];
    const Difference& after = differences[k + 1];
    const bool adjoin = before.sample + 1 == here.sample && here.sample + 1 == after.sample;
    // A reading alone makes −½ of its own difference in both neighbours'.
    const auto is_its_shadow = [&](const Difference& other) {
      return other.value * here.value < -here.value * here.value / 4 &&
             std::abs(other.value) < std::abs(here.value);
    };
    const bool is_off = here.width > 0 && std::abs(here.value) > kFarOff * here.width;
    if (!is_off || !adjoin || !is_its_shadow(before) || !is_its_shadow(after)) continue;
    ++count;
    of_the_off += samples[here.sample].residual * samples[here.sample].residual;
  }
  if (count == 0) return std::nullopt;
  const double all = SquaresOf(samples, ResidualsOf(samples));
  const auto counted = static_cast<double>(CountingSamples(samples));
  HeavyTails fit;
  const auto off = static_cast<double>(count);
  fit.p_value = PoissonAbove(off - 1, kChance * static_cast<double>(differences.size()));
  fit.fraction = off / counted;
  fit.explains = all > 0 ? std::min(of_the_off / all, 1.0) : 0.0;
  // Two widths for one: n ln(SS/n) against that of either share, and who belongs to which.
  const double share = off / counted;
  const double rest = std::max(1 - fit.explains, 1e-300);
  const double mixing = -2 * (share * std::log(share) + (1 - share) * std::log1p(-share));
  const double widths = share * std::log(std::max(fit.explains, 1e-300) / share) +
                        (1 - share) * std::log(rest / (1 - share));
  constexpr double kParameters = 2.0;  // the other width, and the fraction
  fit.delta_aicc = 2 * kParameters - evidence.LikelihoodRatio(1.0, std::exp(mixing + widths));
  return fit;
}

std::optional<HeavyTails> FindHeavyTails(const Problem& problem, std::span<const double> theta,
                                         std::span<const double> residual, const Noise& noise,
                                         Response& response) {
  double squares = 0.0;
  for (const double value : residual) squares += value * value;
  // Rounding errors come in steps of their own.
  if (std::sqrt(squares / static_cast<double>(problem.data->counted)) < kOnlyRounding) return {};
  return FindHeavyTails(SamplesOf(problem, theta, residual, response), Evidence(noise));
}

}  // namespace mindahl::identification
