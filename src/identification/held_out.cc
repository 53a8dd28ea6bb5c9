#include "identification/held_out.h"

#include <algorithm>
#include <cmath>

#include "identification/problem/scaled_records.h"
#include "mindahl/core/error.h"

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
    const bool is_forced = fit.response == loop::Channel::kDisplacement;
    const auto [lowest, highest] =
        std::ranges::minmax(is_forced ? records[r].displacement : records[r].force);
    half_range = std::max(half_range, highest / 2 - lowest / 2);
  }
  samples.rounding = kRoundingRms * half_range;
  return samples;
}

ScoredSquares SquaresOf(const FitResult& fit, const ScoredSamples& samples, std::size_t record) {
  ScoredSquares squares;
  const std::vector<double>& residual = fit.records[record].residual;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (samples.mask[record][i] == 0) continue;
    squares.sum += residual[i] * residual[i];
    ++squares.count;
  }
  return squares;
}

double LikelihoodRms(const FitResult& fit, const ScoredSamples& samples) {
  if (fit.likelihood_rms > 0) return fit.likelihood_rms;
  double logarithms = 0.0;
  double count = 0.0;
  for (std::size_t r = 0; r < samples.mask.size(); ++r) {
    const ScoredSquares squares = SquaresOf(fit, samples, r);
    if (squares.count == 0) continue;
    logarithms += squares.count * std::log(squares.sum / squares.count) / 2;
    count += squares.count;
  }
  return std::exp(logarithms / count);
}

double SumOfSquares(double rms, const ScoredSamples& samples) {
  const double in_units = kRoundingRms * rms / samples.rounding;
  return static_cast<double>(samples.count) * in_units * in_units;
}

std::vector<Part> CyclesOf(const FitResult& fit, const SampleMask& mask) {
  std::vector<Part> parts;
  for (std::size_t r = 0; r < mask.size(); ++r) {
    const std::vector<std::size_t>& reversals = fit.records[r].reversals;
    std::vector<Part> closed;
    for (std::size_t j = 0; j + 2 < reversals.size(); j += 2) {
      Part part{.record = r, .begin = reversals[j], .end = reversals[j + 2]};
      for (std::size_t i = part.begin; i < part.end; ++i) part.samples += mask[r][i];
      if (part.samples > 0) closed.push_back(part);
    }
    if (closed.size() > 1) parts.insert(parts.end(), closed.begin(), closed.end());
  }
  return parts;
}

void HoldInitialStates(const FitResult& fit, FitOptions& options) {
  options.initial_states.clear();
  for (const RecordFit& record : fit.records) {
    options.initial_states.push_back(record.initial_state);
  }
}

void StartFrom(const FitResult& fit, FitOptions& options) {
  for (const ParameterEstimate& parameter : fit.parameters) {
    if (parameter.status != ParameterStatus::kFixed) {
      options.start[parameter.name] = parameter.value;
    }
  }
}

FitOptions ContinuedFrom(const FitResult& fit, FitOptions options) {
  options.model = fit.model;
  HoldInitialStates(fit, options);
  options.preparation.force_sense = fit.force_sense;
  for (const ParameterEstimate& parameter : fit.parameters) {
    if (parameter.status == ParameterStatus::kFixed) continue;
    // One that ran to a bound stays there.
    (parameter.status == ParameterStatus::kFree ? options.start : options.fixed)[parameter.name] =
        parameter.value;
  }
  return options;
}

std::optional<double> PredictParts(std::span<const RecordView> records, FitOptions options,
                                   std::size_t free, const ScoredSamples& samples,
                                   std::span<const Part> parts, std::size_t folds) {
  double squares = 0.0;
  double predicted = 0.0;
  const FitOptions whole = options;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    options.preparation.held_out = HeldOut(records, whole, parts, fold, folds);
    auto left = static_cast<double>(samples.count);
    for (std::size_t c = fold; c < parts.size(); c += folds) left -= parts[c].samples;
    if (left < static_cast<double>(free)) return std::nullopt;
    FitResult fit;
    try {
      fit = Fitter(options).Fit(records, Depth::kEstimate);
    } catch (const InvalidArgument&) {
      return std::nullopt;  // a rig that ran rigid, beyond what the rest of the record can see
    }
    if (!fit.converged) return std::nullopt;
    for (std::size_t c = fold; c < parts.size(); c += folds) {
      const Part& part = parts[c];
      for (std::size_t i = part.begin; i < part.end; ++i) {
        if (samples.mask[part.record][i] == 0) continue;
        const double error = fit.records[part.record].residual[i];
        squares += error * error;
        ++predicted;
      }
    }
  }
  return squares / predicted;
}

}  // namespace mindahl::identification
