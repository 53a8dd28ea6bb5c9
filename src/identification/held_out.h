#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Predictions of parts of records by fits to the rest: what models and terms are chosen by.

/// One vector a record, one entry a sample, 1 where it counts.
using SampleMask = std::vector<std::vector<unsigned char>>;

struct ScoredSamples {
  SampleMask mask;
  std::size_t count = 0;
  double rounding = 0.0;  // [N]: residuals below it mean nothing
};

/// A closed cycle or a stroke, [begin, end).
struct Part {
  std::size_t record = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
  double samples = 0.0;  // that are scored
};

struct MeanOverParts {
  double mean = 0.0;
  double standard_error = 0.0;
};

/// True if the fit found parameters.
bool IsFitted(const FitResult& fit);

/// Returns the samples that count in a fit.
ScoredSamples CountedSamples(const FitResult& fit, std::span<const loop::RecordView> records);

/// Sum of squares [–], in units of rounding, whose own is what Evidence takes for nothing.
double SumOfSquares(double rms, const ScoredSamples& samples);

/// Parts from one reversal to another, of so many strokes each: cycles of two. A single cycle of a
/// record is none: without it nothing of the kind would be left to fit.
/// @param least  parts of a record, which has none where there are fewer
std::vector<Part> PartsOf(const FitResult& fit, const SampleMask& mask, std::size_t skip_cycles,
                          std::size_t strokes, std::size_t least);

/// Gives the options the initial states that a fit found.
void HoldInitialStates(const FitResult& fit, FitOptions& options);

/// Returns options under which the fit is found again from where it is.
FitOptions ContinuedFrom(const FitResult& fit, FitOptions options);

/// Returns the mean square error [N²] of the prediction of each part by fits to the others, dealt
/// in turn to the folds so that slow changes of the contact are in every one; empty where a fit
/// failed. Samples held out still make history.
/// @param options  of those fits, as ContinuedFrom() makes them; what they hold out stays so
/// @param free     parameters of those fits
std::vector<double> PredictParts(std::span<const loop::RecordView> records, FitOptions options,
                                 std::size_t free, const ScoredSamples& samples,
                                 std::span<const Part> parts, std::size_t folds);

/// Mean over samples, with its error from the scatter between parts. The folds' fits share most of
/// their samples, so that their predictions err together: Nadeau & Bengio (2003) add to the
/// variance of a mean over K folds, 1/K, the ratio of predicted to fitted samples, 1/(K − 1).
MeanOverParts Mean(std::span<const double> values, std::span<const Part> parts, std::size_t folds);

/// True if `other` predicts the parts worse than `best` by more than a standard error of the
/// difference and what is rounding.
bool PredictsWorse(std::span<const double> other, std::span<const double> best,
                   std::span<const Part> cycles, std::size_t folds, double rounding);

}  // namespace mindahl::identification
