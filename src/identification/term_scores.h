#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <memory_resource>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "identification/inference/local.h"
#include "identification/problem/problem.h"
#include "mindahl/core/memory.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/preparation.h"
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

/// Cycles from one reversal to the next but one. A single cycle of a record is none: without it
/// nothing of the kind would be left to fit.
std::vector<Part> ClosedCycles(const FitResult& fit, const SampleMask& mask,
                               std::size_t skip_cycles);

/// Strokes from one reversal to the next, likewise; at least four of a record.
std::vector<Part> Strokes(const FitResult& fit, const SampleMask& mask, std::size_t skip_cycles);

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

/// Returns the probability that a mean of zero is found as large or larger, by Student's t.
double ChanceOfMean(const MeanOverParts& mean, std::size_t parts);

/// True if `other` predicts the parts worse than `best` by more than a standard error of the
/// difference and what is rounding.
bool PredictsWorse(std::span<const double> other, std::span<const double> best,
                   std::span<const Part> cycles, std::size_t folds, double rounding);

/// Predicts, to first order, a fit with some more terms.
struct TermScore {
  double rms = 0.0;                 // of the samples that count [N]
  std::vector<double> predictions;  // mean squares [N²] of the parts, each predicted by the others
  /// Probability that chance alone makes the mean of the terms' effects on the parts; empty if the
  /// parts are too few.
  std::optional<double> p_value;
  std::map<std::string, double> values;  // of the terms' parameters, for a search to begin with
  std::map<std::string, double> law;     // by how much θ of σ, α and Tc moves
};

/// Scores terms by one Gauss-Newton step from a fit that does not have them: the residuals are
/// regressed on the Jacobian of the fit and the derivatives by the terms' parameters, of all
/// samples and, for the predictions, of all but those of a fold. Exact for terms that are linear;
/// the cost is that of one Jacobian, whatever the number of folds.
class TermScores {
 public:
  /// @param options     of the fits, with the sign of the force that was found
  /// @param terms       all that will be asked for
  /// @param covariates  likewise
  /// @throws InvalidArgument as a fit with them would
  TermScores(std::span<const loop::RecordView> records, const FitOptions& options,
             std::span<const std::string> terms, std::span<const std::string> covariates);

  /// Returns the samples that do not count under any of the terms.
  [[nodiscard]] std::vector<std::vector<bool>> LeftOut() const;

  /// Takes a fit to step from.
  /// @param options  of that fit
  /// @param parts    that are predicted, dealt in turn to the folds; may be none
  void StepFrom(const FitResult& fit, const FitOptions& options, std::span<const Part> parts,
                std::size_t folds);

  /// Returns the score of the fit itself, with a step of its own.
  [[nodiscard]] TermScore OfFit() const;

  /// Returns the score with more terms; nothing where they have no effect here.
  /// @param with  the options of StepFrom() with the terms
  [[nodiscard]] std::optional<TermScore> Of(const FitOptions& with);

 private:
  TermScores(std::span<const loop::RecordView> records, const FitOptions& options,
             const FitOptions& with_all, std::vector<std::string> covariates);
  [[nodiscard]] Problem ProblemOf(const FitOptions& options) const;
  [[nodiscard]] std::vector<double> ThetaOf(const Problem& problem) const;
  [[nodiscard]] TermScore Solve(const Eigen::MatrixXd& columns, Eigen::VectorXd& step) const;
  [[nodiscard]] std::optional<double> TestEffects(const Eigen::MatrixXd& added) const;
  /// Returns the first row and the number of rows of each part.
  [[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> RowsOfParts() const;

  Arena arena_;
  std::vector<std::string> covariates_;
  loop::PreparedRecords prepared_;
  ScaledRecords data_;
  Response response_;
  // The fit from which the steps are taken:
  std::map<std::string, double> values_;  // of its parameters
  std::set<std::string> free_;            // of these
  models::InitialState state_ = models::InitialState::kSteady;
  Linearization at_fit_;            // in those that are inside their bounds
  std::vector<std::string> names_;  // of these
  std::span<const Part> parts_;
  std::size_t folds_ = 0;
};

}  // namespace mindahl::identification
