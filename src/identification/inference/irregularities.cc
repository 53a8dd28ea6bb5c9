#include "identification/inference/irregularities.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/dense.h"
#include "identification/inference/noise.h"

namespace mindahl::identification {

namespace {

enum IrregularityRow : std::size_t { kHeavyTails, kStickSlip, kRipple };

constexpr std::array<Irregularity, 3> kIrregularities = {{
    {.code = "heavy_tails",
     .meaning = "fraction of the readings that are far off both their neighbours",
     .unit = "-",
     .option = "--loss huber"},
    {.code = "stick_slip",
     .meaning = "median drop of the force, against the motion, while the contact slides",
     .unit = "N",
     .option = ""},
    {.code = "position_ripple",
     .meaning = "period along the displacement of a force that has one phase in all strokes of a "
                "direction",
     .unit = "m",
     .option = "--ripple PERIOD"},
}};

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
                         .displacement = record.displacement[i],
                         .response = force[k],
                         .residual = residual[k],
                         .counts = record.counts[i] != 0,
                         .turns = turns});
    }
  }
  return samples;
}

}  // namespace

std::span<const Irregularity> Irregularities() { return kIrregularities; }

std::vector<IrregularityFit> FindIrregularities(const Problem& problem,
                                                std::span<const double> theta,
                                                std::span<const double> residual,
                                                const Noise& noise, bool robust, bool doubtful,
                                                Response& response) {
  std::vector<IrregularityFit> found;
  double squares = 0.0;
  for (const double value : residual) squares += value * value;
  // Rounding errors come in steps of their own.
  const double rms = std::sqrt(squares / static_cast<double>(problem.data->counted));
  if (rms < kOnlyRounding) return found;
  const std::vector<FittedSample> samples = SamplesOf(problem, theta, residual, response);
  const Evidence evidence(noise);
  const auto add = [&](std::size_t row, std::optional<IrregularityFit> fit) {
    if (!fit) return;
    fit->irregularity = row;
    found.push_back(*fit);
  };
  if (!robust) add(kHeavyTails, FindHeavyTails(samples, evidence));
  // A force that is imposed drops by itself.
  if (problem.data->is_forced()) return found;
  // One phase in all strokes is the drive's: stick-slip of a contact has none.
  const std::optional<IrregularityFit> stick_slip = FindStickSlip(samples);
  const bool is_fitted = std::ranges::any_of(problem.parameters.free(), [&](std::size_t p) {
    return problem.parameters[p].term->option == "--ripple";
  });
  std::optional<IrregularityFit> ripple;
  if (!is_fitted && (doubtful || stick_slip)) ripple = FindRipple(samples);
  if (ripple) {
    add(kRipple, ripple);
  } else {
    add(kStickSlip, stick_slip);
  }
  return found;
}

namespace {

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

/// Weighs fits by the independent samples among what one of them leaves.
Evidence EvidenceOf(std::span<const FittedSample> samples, std::span<const double> left) {
  std::vector<unsigned char> counts;
  for (const FittedSample& sample : samples) counts.push_back(sample.counts ? 1 : 0);
  const std::span<const unsigned char> mask = counts;
  const std::size_t counted = CountingSamples(samples);
  const double correlated = EstimateAutocorrelation({&left, 1}, {&mask, 1}).SquaredCorrelations();
  return Evidence(counted, static_cast<double>(counted) / correlated);
}

double PeakOf(std::span<const FittedSample> samples) {
  double peak = 0.0;
  for (const FittedSample& sample : samples) peak = std::max(peak, std::abs(sample.response));
  return peak;
}

constexpr double kNormalMedian = 0.6744897501960817;  // of |z|
constexpr std::size_t kAlike = 60;                    // samples that one width is taken from
constexpr double kFar = 6.0;                          // of their widths
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
    const double width =
        boost::math::statistics::median(sizes.begin(), sizes.end()) / kNormalMedian;
    for (std::size_t k = begin; k < end; ++k) differences[order[k]].width = width;
  }
}

}  // namespace

std::optional<IrregularityFit> FindHeavyTails(std::span<const FittedSample> samples,
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
    const bool is_off = here.width > 0 && std::abs(here.value) > kFar * here.width;
    if (!is_off || !adjoin || !is_its_shadow(before) || !is_its_shadow(after)) continue;
    ++count;
    of_the_off += samples[here.sample].residual * samples[here.sample].residual;
  }
  if (count == 0) return std::nullopt;
  const double all = SquaresOf(samples, ResidualsOf(samples));
  const auto counted = static_cast<double>(CountingSamples(samples));
  IrregularityFit fit;
  const auto off = static_cast<double>(count);
  fit.p_value = PoissonAbove(off - 1, kChance * static_cast<double>(differences.size()));
  fit.size = off / counted;
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

namespace {

constexpr double kSliding = 0.8;          // of the largest force: the plateau
constexpr double kLarge = 5.0;            // deviations of the steps
constexpr double kNormal = 1.4826;        // standard deviation over median deviation
constexpr std::size_t kFewestSteps = 20;  // steps that determine their own deviation

/// The residual's change from one sample to the next while the contact slides, as the measured
/// force grows along the motion.
struct Step {
  std::size_t sample = 0;  // the first of the two
  double growth = 0.0;
};

std::vector<Step> StepsOfSliding(std::span<const FittedSample> samples) {
  const double peak = PeakOf(samples);
  std::vector<Step> steps;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const FittedSample& here = samples[i];
    const FittedSample& next = samples[i + 1];
    if (here.record != next.record || !here.counts || !next.counts) continue;
    const double way = next.displacement - here.displacement;
    if (way == 0) continue;
    const double sense = way > 0 ? 1.0 : -1.0;
    const auto slides = [&](const FittedSample& at) {
      return sense * at.response > kSliding * peak;
    };
    if (slides(here) && slides(next)) {
      steps.push_back({i, -sense * (next.residual - here.residual)});
    }
  }
  return steps;
}

/// The residuals once each tooth on the plateau has its own mean and all have one slope along the
/// way.
struct Teeth {
  std::vector<double> left;  // of all samples
  std::size_t count = 0;
};

Teeth FitTeeth(std::span<const FittedSample> samples, std::span<const Step> steps,
               const std::vector<bool>& is_drop) {
  Teeth teeth{.left = ResidualsOf(samples)};
  std::vector<double> way(samples.size());  // from the tooth's middle
  double xx = 0.0;
  double xr = 0.0;
  for (std::size_t k = 0; k < steps.size(); ++teeth.count) {
    const std::size_t begin = steps[k].sample;
    while (!is_drop[k] && k + 1 < steps.size() && steps[k + 1].sample == steps[k].sample + 1) ++k;
    const std::size_t end = steps[k].sample + (is_drop[k] ? 1 : 2);
    ++k;
    const auto count = static_cast<double>(end - begin);
    double mean_x = 0.0;
    double mean_r = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      mean_x += samples[i].displacement / count;
      mean_r += samples[i].residual / count;
    }
    for (std::size_t i = begin; i < end; ++i) {
      way[i] = samples[i].displacement - mean_x;
      teeth.left[i] -= mean_r;
      xx += way[i] * way[i];
      xr += way[i] * teeth.left[i];
    }
  }
  if (!(xx > 0)) return teeth;
  for (std::size_t i = 0; i < samples.size(); ++i) teeth.left[i] -= xr / xx * way[i];
  return teeth;
}

}  // namespace

std::optional<IrregularityFit> FindStickSlip(std::span<const FittedSample> samples) {
  const std::vector<Step> steps = StepsOfSliding(samples);
  if (steps.size() < kFewestSteps) return std::nullopt;
  std::vector<double> growths;
  growths.reserve(steps.size());
  for (const Step& step : steps) growths.push_back(step.growth);
  std::vector<double> work = growths;
  const double middle = boost::math::statistics::median(work.begin(), work.end());
  for (double& growth : work) growth = std::abs(growth - middle);
  const double width = kNormal * boost::math::statistics::median(work.begin(), work.end());
  std::vector<bool> is_drop(steps.size(), false);
  std::vector<double> drops;
  std::size_t rises = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const double from_middle = growths[k] - middle;
    if (from_middle > kLarge * width) ++rises;
    is_drop[k] = from_middle < -kLarge * width;
    if (is_drop[k]) drops.push_back(-from_middle);
  }
  if (drops.empty()) return std::nullopt;
  const Teeth teeth = FitTeeth(samples, steps, is_drop);
  const double before = SquaresOf(samples, ResidualsOf(samples));
  const double after = SquaresOf(samples, teeth.left);
  IrregularityFit fit;
  const auto count = static_cast<double>(drops.size());
  fit.p_value = BinomialAbove(count - 1, count + static_cast<double>(rises), 0.5);
  fit.size = boost::math::statistics::median(drops.begin(), drops.end());
  fit.explains = before > 0 ? std::clamp(1 - after / before, 0.0, 1.0) : 0.0;
  // The teeth autocorrelate the residuals: the rest determines how many are independent.
  const Evidence evidence = EvidenceOf(samples, teeth.left);
  const double parameters = static_cast<double>(teeth.count) + 1;  // a mean a tooth, and the slope
  fit.delta_aicc = 2 * parameters - evidence.LikelihoodRatio(before, after);
  return fit;
}

namespace {

constexpr double kOnPlateau = 0.8;           // of the largest force: the plateau
constexpr std::size_t kFewestReadings = 16;  // of a stroke
constexpr std::size_t kFewestStrokes = 2;    // of a direction, to share a phase
constexpr std::size_t kMostPoints = 256;     // that a stroke is looked at by
constexpr std::size_t kMostStrokes = 64;     // that the period is looked for in
constexpr double kFewestPeriods = 3.0;       // on the plateau
constexpr double kReadingsAPeriod = 4.0;     // at least
constexpr int kFinest = 10;                  // parts of the step between frequencies, at last
constexpr double kOfFree = 0.8;              // of what a phase for each stroke explains
constexpr double kOfAnyFree = 0.3;           // likewise of another period
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
  const auto count = static_cast<Eigen::Index>(x.size());
  Eigen::Map<Eigen::VectorXd> values(y.data(), count);
  const Eigen::Map<const Eigen::VectorXd> places(x.data(), count);
  const Eigen::VectorXd away = places.array() - places.mean();
  const double squares = away.squaredNorm();
  const double slope = squares > 0 ? away.dot(values) / squares : 0.0;
  values.array() -= values.mean();
  values -= slope * away;
}

std::vector<Plateau> PlateausOf(std::span<const FittedSample> samples) {
  const double peak = PeakOf(samples);
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
    if (i - begin < kFewestReadings) continue;
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
  std::vector<double> left = ResidualsOf(samples);
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
    const Eigen::VectorXd factors = PseudoInverse(normal) * right;
    for (const Plateau& plateau : plateaus) {
      if (plateau.rises != rises) continue;
      for (std::size_t i = plateau.begin; i < plateau.end; ++i) {
        left[i] -= columns_at(samples[i].displacement).dot(factors);
      }
    }
  }
  return left;
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
  std::size_t tried = 0;
  PhaseFit most;
  double most_by_free = 0.0;  // at any frequency
  const auto look_at = [&](double frequency) {
    const PhaseFit explained = ExplainedAt(frequency, plateaus);
    most_by_free = std::max(most_by_free, explained.by_free);
    if (!(explained.by_one > most.by_one)) return;
    most = explained;
    best = frequency;
  };
  const double lowest = kFewestPeriods / length;
  for (double frequency = lowest; frequency <= highest;) {
    look_at(frequency);
    frequency = lowest + static_cast<double>(++tried) * step;
  }
  if (!(most.by_one > 0)) return std::nullopt;
  const double coarse = best;
  for (int part = -kFinest; part <= kFinest; ++part) look_at(coarse + part * step / kFinest);
  // For noise, free phases explain more by a factor of the number of strokes.
  if (most.by_one < std::max(kOfFree * most.by_free, kOfAnyFree * most_by_free)) {
    return std::nullopt;
  }

  const std::vector<double> left = WithoutRipple(samples, plateaus, best);
  const double before = SquaresOf(samples, ResidualsOf(samples));
  const double after = SquaresOf(samples, left);
  const Evidence evidence = EvidenceOf(samples, left);
  constexpr double kColumns = 4.0 * kHarmonics;
  const double degrees = evidence.effective() - kColumns;
  if (!(degrees > 1) || !(after > 0) || !(before > after)) return std::nullopt;
  const double f = (before - after) / kColumns / (after / degrees);
  IrregularityFit ripple;
  ripple.p_value = std::min(1.0, static_cast<double>(tried) * PValueOfF(f, kColumns, degrees));
  ripple.size = 1 / best;
  ripple.explains = 1 - after / before;
  ripple.delta_aicc = 2 * (kColumns + 1) - evidence.LikelihoodRatio(before, after);
  return ripple;
}

}  // namespace mindahl::identification
