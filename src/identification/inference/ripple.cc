#include "identification/inference/ripple.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/inference/evidence.h"
#include "identification/inference/noise.h"

namespace mindahl::identification {
namespace {

constexpr double kOnPlateau = 0.8;         // of the largest force: the plateau
constexpr std::size_t kFewest = 16;        // readings of a stroke
constexpr std::size_t kFewestStrokes = 2;  // of a direction, to share a phase
constexpr std::size_t kMostPoints = 256;   // that a stroke is looked at by
constexpr std::size_t kMostStrokes = 64;   // that the period is looked for in
constexpr double kFewestPeriods = 3.0;     // on the plateau
constexpr double kReadingsAPeriod = 4.0;   // at least
constexpr double kFinest = 1.0 / 10;       // of the step between frequencies, at last
constexpr double kOfFree = 0.8;            // of what a phase for each stroke explains
constexpr double kOfAnyFree = 0.3;         // likewise of another period
constexpr Eigen::Index kHarmonics = 3;

/// A stroke's plateau: residuals less their own line.
struct Plateau {
  bool rises = true;
  std::size_t begin = 0;  // samples
  std::size_t end = 0;
  std::vector<double> displacement;
  std::vector<double> residual;

  [[nodiscard]] double length() const {
    const auto [least, most] = std::ranges::minmax(displacement);
    return most - least;
  }
};

void TakeOffLine(std::span<const double> x, std::span<double> y) {
  const auto count = static_cast<double>(x.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / count;
    mean_y += y[i] / count;
  }
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  const double slope = xx > 0 ? xy / xx : 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) y[i] -= mean_y + slope * (x[i] - mean_x);
}

std::vector<Plateau> PlateausOf(std::span<const FittedSample> samples) {
  double peak = 0.0;
  for (const FittedSample& sample : samples) peak = std::max(peak, std::abs(sample.response));
  const auto slides = [&](const FittedSample& at) {
    return at.counts && std::abs(at.response) > kOnPlateau * peak;
  };
  std::vector<Plateau> plateaus;
  for (std::size_t i = 0; i < samples.size();) {
    const std::size_t begin = i;
    const auto is_same = [&](const FittedSample& at) {
      return slides(at) && at.record == samples[begin].record &&
             at.response * samples[begin].response > 0;
    };
    while (i < samples.size() && is_same(samples[i])) ++i;
    if (i == begin) ++i;
    if (i - begin < kFewest) continue;
    Plateau plateau;
    plateau.rises = samples[begin].response > 0;
    plateau.begin = begin;
    plateau.end = i;
    const std::size_t group = (i - begin + kMostPoints - 1) / kMostPoints;
    for (std::size_t k = begin; k + group <= i; k += group) {
      double x = 0.0;
      double r = 0.0;
      for (std::size_t j = k; j < k + group; ++j) {
        x += samples[j].displacement / static_cast<double>(group);
        r += samples[j].residual / static_cast<double>(group);
      }
      plateau.displacement.push_back(x);
      plateau.residual.push_back(r);
    }
    TakeOffLine(plateau.displacement, plateau.residual);
    plateaus.push_back(std::move(plateau));
    if (plateaus.size() == kMostStrokes) break;
  }
  return plateaus;
}

/// Sums of squares that a cosine and a sine of one frequency explain.
struct PhaseFit {
  double by_one = 0.0;   // phase for each direction
  double by_free = 0.0;  // phase for each stroke
};

PhaseFit ExplainedAt(double frequency, std::span<const Plateau> plateaus) {
  std::array<std::complex<double>, 2> sums{};
  std::array<double, 2> counts{};
  PhaseFit explained;
  for (const Plateau& plateau : plateaus) {
    std::complex<double> sum;
    for (std::size_t i = 0; i < plateau.residual.size(); ++i) {
      const double phase = 2 * std::numbers::pi * frequency * plateau.displacement[i];
      sum += plateau.residual[i] * std::complex(std::cos(phase), std::sin(phase));
    }
    const auto count = static_cast<double>(plateau.residual.size());
    explained.by_free += 2 * std::norm(sum) / count;
    sums[plateau.rises ? 0 : 1] += sum;
    counts[plateau.rises ? 0 : 1] += count;
  }
  for (std::size_t d = 0; d < sums.size(); ++d) {
    if (counts[d] > 0) explained.by_one += 2 * std::norm(sums[d]) / counts[d];
  }
  return explained;
}

/// The residuals without the period's first harmonics, by least squares in each direction; a line
/// for each stroke, which is no part of the ripple, is left in.
std::vector<double> WithoutRipple(std::span<const FittedSample> samples,
                                  std::span<const Plateau> plateaus, double frequency) {
  std::vector<double> left;
  for (const FittedSample& sample : samples) left.push_back(sample.residual);
  for (const bool rises : {true, false}) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(2 * kHarmonics, 2 * kHarmonics);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * kHarmonics);
    const auto columns_at = [&](double x) {
      Eigen::VectorXd columns(2 * kHarmonics);
      for (Eigen::Index h = 0; h < kHarmonics; ++h) {
        const double phase = 2 * std::numbers::pi * frequency * static_cast<double>(h + 1) * x;
        columns[2 * h] = std::cos(phase);
        columns[2 * h + 1] = std::sin(phase);
      }
      return columns;
    };
    for (const Plateau& plateau : plateaus) {
      if (plateau.rises != rises) continue;
      for (std::size_t i = 0; i < plateau.residual.size(); ++i) {
        const Eigen::VectorXd columns = columns_at(plateau.displacement[i]);
        normal += columns * columns.transpose();
        right += plateau.residual[i] * columns;
      }
    }
    const Eigen::VectorXd factors = normal.completeOrthogonalDecomposition().solve(right);
    for (const Plateau& plateau : plateaus) {
      if (plateau.rises != rises) continue;
      for (std::size_t i = plateau.begin; i < plateau.end; ++i) {
        left[i] -= columns_at(samples[i].displacement).dot(factors);
      }
    }
  }
  return left;
}

double IndependentSamples(std::span<const FittedSample> samples, const std::vector<double>& left,
                          std::size_t counted) {
  std::vector<unsigned char> counts;
  for (const FittedSample& sample : samples) counts.push_back(sample.counts ? 1 : 0);
  const std::span<const double> values = left;
  const std::span<const unsigned char> mask = counts;
  return static_cast<double>(counted) /
         EstimateAutocorrelation({&values, 1}, {&mask, 1}).SquaredCorrelations();
}

}  // namespace

std::optional<IrregularityFit> FindRipple(std::span<const FittedSample> samples) {
  const std::vector<Plateau> plateaus = PlateausOf(samples);
  std::array<std::size_t, 2> strokes{};
  double length = 0.0;
  double travel = 0.0;
  double points = 0.0;
  for (const Plateau& plateau : plateaus) {
    ++strokes[plateau.rises ? 0 : 1];
    length = std::max(length, plateau.length());
    travel += plateau.length();
    points += static_cast<double>(plateau.residual.size());
  }
  if (std::ranges::max(strokes) < kFewestStrokes || !(length > 0)) return std::nullopt;
  const double step = 1 / (2 * length);
  const double highest = points / kReadingsAPeriod / travel;
  double best = 0.0;
  double tried = 0.0;
  PhaseFit most;
  double most_by_free = 0.0;  // at any frequency
  const auto look_at = [&](double frequency) {
    const PhaseFit explained = ExplainedAt(frequency, plateaus);
    most_by_free = std::max(most_by_free, explained.by_free);
    if (!(explained.by_one > most.by_one)) return;
    most = explained;
    best = frequency;
  };
  for (double frequency = kFewestPeriods / length; frequency <= highest; frequency += step) {
    look_at(frequency);
    ++tried;
  }
  if (!(most.by_one > 0)) return std::nullopt;
  const double coarse = best;
  for (double part = -1; part <= 1; part += kFinest) look_at(coarse + part * step);
  // For noise, free phases explain more by a factor of the number of strokes.
  if (most.by_one < std::max(kOfFree * most.by_free, kOfAnyFree * most_by_free)) {
    return std::nullopt;
  }

  const std::vector<double> left = WithoutRipple(samples, plateaus, best);
  double before = 0.0;
  double after = 0.0;
  std::size_t counted = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].counts) continue;
    before += samples[i].residual * samples[i].residual;
    after += left[i] * left[i];
    ++counted;
  }
  const double effective = IndependentSamples(samples, left, counted);
  constexpr double kColumns = 4.0 * kHarmonics;
  const double degrees = effective - kColumns;
  if (!(degrees > 1) || !(after > 0) || !(before > after)) return std::nullopt;
  const double f = (before - after) / kColumns / (after / degrees);
  IrregularityFit ripple;
  ripple.p_value = std::min(1.0, tried * PValueOfF(f, kColumns, degrees));
  ripple.size = 1 / best;
  ripple.explains = 1 - after / before;
  ripple.delta_aicc =
      2 * (kColumns + 1) - Evidence(counted, effective).LikelihoodRatio(before, after);
  return ripple;
}

}  // namespace mindahl::identification
