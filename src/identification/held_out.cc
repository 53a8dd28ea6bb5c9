#include "identification/held_out.h"

#include <algorithm>
#include <cmath>

#include "identification/inference/noise.h"

namespace mindahl::identification {

using loop::RecordView;

namespace {

/// Returns those that the options hold out, and the parts of one fold.
std::vector<std::vector<bool>> HeldOut(std::span<const RecordView> records,
                                       const FitOptions& options, std::span<const Part> parts,
                                       std::size_t fold, std::size_t folds) {
  std::vector<std::vector<bool>> mask = options.preparation.held_out;
  mask.resize(records.size());
  for (std::size_t r = 0; r < records.size(); ++r) mask[r].resize(records[r].size(), false);
  for (std::size_t c = fold; c < parts.size(); c += folds) {
    std::vector<bool>& held_out = mask[parts[c].record];
    std::fill(held_out.begin() + static_cast<std::ptrdiff_t>(parts[c].begin),
              held_out.begin() + static_cast<std::ptrdiff_t>(parts[c].end), true);
  }
  return mask;
}

}  // namespace

bool IsFitted(const FitResult& fit) { return !fit.parameters.empty(); }

ScoredSamples CountedSamples(const FitResult& fit, std::span<const RecordView> records) {
  ScoredSamples samples;
  double half_range = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const std::vector<unsigned char>& counts = fit.records[r].counts;
    samples.mask.emplace_back(counts);
    samples.count += counts.size() - fit.records[r].left_out;
    const auto [lowest, highest] = std::ranges::minmax(records[r].force);
    half_range = std::max(half_range, highest / 2 - lowest / 2);
  }
  samples.rounding = kRoundingRms * half_range;
  return samples;
}

double SumOfSquares(double rms, const ScoredSamples& samples) {
  const double in_units = kRoundingRms * rms / samples.rounding;
  return static_cast<double>(samples.count) * in_units * in_units;
}

std::vector<Part> PartsOf(const FitResult& fit, const SampleMask& mask, std::size_t skip_cycles,
                          std::size_t strokes, std::size_t least) {
  std::vector<Part> parts;
  const std::size_t first = skip_cycles > 0 ? 2 * skip_cycles - 1 : 0;
  for (std::size_t r = 0; r < mask.size(); ++r) {
    const std::vector<std::size_t>& reversals = fit.records[r].reversals;
    std::vector<Part> closed;
    for (std::size_t j = first; j + strokes < reversals.size(); j += strokes) {
      Part part{.record = r, .begin = reversals[j], .end = reversals[j + strokes]};
      for (std::size_t i = part.begin; i < part.end; ++i) part.samples += mask[r][i];
      if (part.samples > 0) closed.push_back(part);
    }
    if (closed.size() >= least) parts.insert(parts.end(), closed.begin(), closed.end());
  }
  return parts;
}

void HoldInitialStates(const FitResult& fit, FitOptions& options) {
  options.initial_states.clear();
  for (const RecordFit& record : fit.records) {
    options.initial_states.push_back(record.initial_state);
  }
}

FitOptions ContinuedFrom(const FitResult& fit, FitOptions options) {
  options.model = fit.model;
  HoldInitialStates(fit, options);
  options.preparation.force_sense = fit.force_sense;
  options.starts = 1;
  for (const ParameterEstimate& parameter : fit.parameters) {
    if (parameter.status == ParameterStatus::kFixed) continue;
    // One that ran to a bound stays there.
    (parameter.status == ParameterStatus::kFree ? options.start : options.fixed)[parameter.name] =
        parameter.value;
  }
  return options;
}

std::vector<double> PredictParts(std::span<const RecordView> records, FitOptions options,
                                 std::size_t free, const ScoredSamples& samples,
                                 std::span<const Part> parts, std::size_t folds) {
  std::vector<double> mean_square(parts.size(), 0.0);
  const FitOptions whole = options;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    options.preparation.held_out = HeldOut(records, whole, parts, fold, folds);
    auto left = static_cast<double>(samples.count);
    for (std::size_t c = fold; c < parts.size(); c += folds) left -= parts[c].samples;
    if (left < static_cast<double>(free)) return {};
    Fitter fitter(options);
    const FitResult& fit = fitter.Fit(records, Depth::kEstimate);
    if (!fit.converged) return {};
    for (std::size_t c = fold; c < parts.size(); c += folds) {
      const Part& part = parts[c];
      for (std::size_t i = part.begin; i < part.end; ++i) {
        if (samples.mask[part.record][i] == 0) continue;
        const double error = fit.records[part.record].residual[i];
        mean_square[c] += error * error / part.samples;
      }
    }
  }
  return mean_square;
}

MeanOverParts Mean(std::span<const double> values, std::span<const Part> parts, std::size_t folds) {
  double samples = 0.0;
  double sum = 0.0;
  for (std::size_t c = 0; c < values.size(); ++c) {
    samples += parts[c].samples;
    sum += parts[c].samples * values[c];
  }
  MeanOverParts result{.mean = sum / samples};
  double squares = 0.0;
  for (std::size_t c = 0; c < values.size(); ++c) {
    const double deviation = parts[c].samples / samples * (values[c] - result.mean);
    squares += deviation * deviation;
  }
  const auto count = static_cast<double>(values.size());
  const auto of_folds = static_cast<double>(folds);
  result.standard_error =
      std::sqrt(squares * count / (count - 1) * (1 + of_folds / (of_folds - 1)));
  return result;
}

bool PredictsWorse(std::span<const double> other, std::span<const double> best,
                   std::span<const Part> cycles, std::size_t folds, double rounding) {
  if (other.empty() || best.empty()) return false;
  std::vector<double> difference;
  difference.reserve(cycles.size());
  for (std::size_t c = 0; c < cycles.size(); ++c) difference.push_back(other[c] - best[c]);
  const MeanOverParts mean = Mean(difference, cycles, folds);
  return mean.mean > mean.standard_error + rounding * rounding;
}

}  // namespace mindahl::identification
