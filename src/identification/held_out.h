#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Two measures compare fits: the rms of their residuals, and the error with which a fit to one
/// part of a record predicts the rest.

/// One vector a record, one entry a sample, 1 where it counts.
using SampleMask = std::vector<std::vector<unsigned char>>;

struct ScoredSamples {
  SampleMask mask;
  std::size_t count = 0;
  double rounding = 0.0;  // [unit of the response]: residuals below it mean nothing
};

/// A closed cycle, [begin, end).
struct Part {
  std::size_t record = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
  double samples = 0.0;  // that are scored
};

/// True if the fit found parameters.
bool IsFitted(const FitResult& fit);

/// Returns the samples that count in a fit.
ScoredSamples CountedSamples(const FitResult& fit, std::span<const loop::RecordView> records);

/// The residuals of a record that are scored.
struct ScoredSquares {
  double sum = 0.0;  // [unit of the response, squared]
  double count = 0.0;
};
ScoredSquares SquaresOf(const FitResult& fit, const ScoredSamples& samples, std::size_t record);

/// The rms [unit of the response] by which fits are compared: where the displacement is inexact
/// FitResult::likelihood_rms, else of records whose noise differs the mean of the logarithms over
/// the samples, so that each counts by its own noise.
double LikelihoodRms(const FitResult& fit, const ScoredSamples& samples);

/// Sum of squares [–], in units of rounding, whose own is what Evidence takes for nothing.
double SumOfSquares(double rms, const ScoredSamples& samples);

/// Returns the cycles from one reversal to the next but one. A single one of a record is none:
/// without it nothing of the kind would be left to fit.
std::vector<Part> CyclesOf(const FitResult& fit, const SampleMask& mask);

/// Gives the options the initial states that a fit found.
void HoldInitialStates(const FitResult& fit, FitOptions& options);

/// Gives the options the values that a fit found, for a search to begin with.
void StartFrom(const FitResult& fit, FitOptions& options);

/// Returns options under which the fit is found again from where it is.
FitOptions ContinuedFrom(const FitResult& fit, FitOptions options);

/// Returns the mean square error [N²] of the prediction of parts by fits to the others, dealt in
/// turn to the folds so that slow changes of the contact are in every one; empty where a fit
/// failed or refused its options. Samples held out still make history.
/// @param options  of those fits, as ContinuedFrom() makes them; what they hold out stays so
/// @param free     parameters of those fits
std::optional<double> PredictParts(std::span<const loop::RecordView> records, FitOptions options,
                                   std::size_t free, const ScoredSamples& samples,
                                   std::span<const Part> parts, std::size_t folds);

}  // namespace mindahl::identification
