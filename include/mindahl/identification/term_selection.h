#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Sets how terms are added to the law.
struct TermSelectionOptions {
  /// Parts into which cycles or strokes are divided for prediction; odd, so that each has strokes
  /// of both directions.
  std::size_t folds = 5;
  /// Largest probability with which the gain of a term that is added is chance, over all candidates
  /// of a round (Bonferroni).
  double chance = 0.05;
  /// Least fraction by which the error of prediction falls with a term that is added.
  double smallest_gain = 0.03;
  std::size_t most_fits = 15;  ///< in all, nearly all of them at Depth::kEstimate
  Depth depth = Depth::kFull;  ///< depth of the fit that is returned
  /// Names of groups that the options have: they are added one after the other, each from the
  /// solution without it, and are not judged. Nothing is selected then.
  std::vector<std::string> named = {};
};

/// A candidate and what it gained in the last round in which it was tried.
struct ConsideredTerm {
  std::string name;  ///< name of the group, or NameOfCovariate()
  /// Fraction by which the rms error of predicted cycles would fall to first order, of fitted
  /// samples where `is_predicted` is false; of a term that is added that of the fit falls [–].
  double gain = 0.0;
  double p_value = 1.0;  ///< probability that the gain to first order is chance
  bool is_predicted = false;
  bool added = false;
  /// Reason why it was not added: "", of one that gains "confounded", "unphysical" or
  /// "not_converged", of a column that repeats another one "same_channel".
  std::string_view obstacle;
};

struct TermSelection {
  std::vector<ConsideredTerm>
      considered;  ///< those added first, in their order; then by their gain
  std::vector<std::string> added;
  std::size_t held_out_parts = 0;  ///< cycles or strokes, each predicted once
  std::size_t estimates = 0;       ///< fits that were made, at any depth
  FitOptions options;              ///< with the terms that were added
  FitResult fit;                   ///< with them
};

/// Fits a record with the terms that it requires and no others (forward selection).
///
/// A record that the law describes adequately gets none: its fit is Fit()'s to the last digit.
/// Otherwise every candidate for which there are data is scored by one Gauss-Newton step from the
/// present solution: on cycles held out of that step, on strokes where there are fewer than four
/// cycles, by the fitted samples where there are fewer than four strokes. Of those that lower the
/// error by `smallest_gain`, not by chance, the best is fitted, or what has some of its terms only
/// and gains half as much; it is added unless its fit does not converge, gains less, ends at a
/// bound or leaves the half gap, else the next one is tried. The rounds end when none is added or
/// `most_fits` are made.
///
/// *Confounded terms.* A covariate is not added where it is a copy of a channel that is fitted, of
/// a candidate before it or of the velocity, or where it follows the contact's force, |r| > 0.3:
/// its factor and the slip force then share what the record shows. No term is added with which Tc
/// of a loop that slides leaves the half gap that was measured, unless it leaves nothing but noise.
/// @param records  [m], [N]
/// @param options  of every fit; a term that these have is no candidate
/// @throws InvalidArgument as Fit does, for folds < 2 or a chance outside (0, 1)
/// Deterministic. Nothing is selected in a fit of the displacement.
TermSelection SelectTerms(std::span<const loop::RecordView> records, const FitOptions& options,
                          const TermSelectionOptions& selection = {});
TermSelection SelectTerms(std::span<const loop::Record> records, const FitOptions& options,
                          const TermSelectionOptions& selection = {});

/// Returns the terms that explain what a fit misses, the one that leaves least first: the `most`
/// that score best as SelectTerms() scores its candidates, a gap that was measured before all, are
/// fitted at Depth::kEstimate, and those with an obstacle to them left out.
/// @param options  of the fit
std::vector<std::string> LikelyTerms(std::span<const loop::RecordView> records,
                                     const FitOptions& options, const FitResult& fit,
                                     std::size_t most);

}  // namespace mindahl::identification
