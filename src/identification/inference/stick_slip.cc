#include "identification/inference/stick_slip.h"

#include <algorithm>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <vector>

#include "core/probability.h"
#include "identification/inference/evidence.h"
#include "identification/inference/noise.h"

namespace mindahl::identification {
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
  double peak = 0.0;
  for (const FittedSample& sample : samples) peak = std::max(peak, std::abs(sample.response));
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
  Teeth teeth;
  std::vector<double> way(samples.size());  // from the tooth's middle
  for (const FittedSample& sample : samples) teeth.left.push_back(sample.residual);
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
  std::vector<unsigned char> counts;
  double before = 0.0;
  double after = 0.0;
  std::size_t counted = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    counts.push_back(samples[i].counts ? 1 : 0);
    if (!samples[i].counts) continue;
    before += samples[i].residual * samples[i].residual;
    after += teeth.left[i] * teeth.left[i];
    ++counted;
  }
  IrregularityFit fit;
  const auto count = static_cast<double>(drops.size());
  fit.p_value = BinomialAbove(count - 1, count + static_cast<double>(rises), 0.5);
  fit.size = boost::math::statistics::median(drops.begin(), drops.end());
  fit.explains = before > 0 ? std::clamp(1 - after / before, 0.0, 1.0) : 0.0;
  // The teeth autocorrelate the residuals: the rest determines how many are independent.
  const std::span<const double> left = teeth.left;
  const std::span<const unsigned char> mask = counts;
  const double effective = static_cast<double>(counted) /
                           EstimateAutocorrelation({&left, 1}, {&mask, 1}).SquaredCorrelations();
  const Evidence evidence(counted, effective);
  const double parameters = static_cast<double>(teeth.count) + 1;  // a mean a tooth, and the slope
  fit.delta_aicc = 2 * parameters - evidence.LikelihoodRatio(before, after);
  return fit;
}

}  // namespace mindahl::identification
