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
  /// Least fraction by which the error of prediction falls with a term that is added, unless the
  /// model is adequate with it.
  double smallest_gain = 0.03;
  std::size_t most_terms = 7;  ///< largest number of added terms
  std::size_t most_fits = 15;  ///< in all, nearly all of them at Depth::kEstimate
  /// If true, adds no term where the law is of no use with terms, none to a law that is of
  /// quantitative use alone and knows Tc within a quarter, and to one that does not know it only
  /// terms with which it is adequate.
  bool only_for_use = false;
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
  /// Reason why it was not added: "", of one that gains "confounded", "rate_dependent" or
  /// "unphysical", of a column that was not tried since it repeats another one "same_channel".
  std::string_view obstacle;
};

struct TermSelection {
  std::vector<ConsideredTerm>
      considered;  ///< those added first, in their order; then by their gain
  std::vector<std::string> added;
  std::size_t held_out_parts = 0;  ///< cycles or strokes, each predicted once; 0: AICc decided
  std::size_t estimates = 0;       ///< fits that were made, at any depth
  FitOptions options;              ///< with the terms that were added
  FitResult fit;                   ///< with them, at Depth::kFull
};

/// Fits a record with the terms that it requires and no others (forward selection).
///
/// A record that the law describes adequately gets none: its fit is Fit()'s to the last digit.
/// Otherwise every candidate for which there are data is scored by one Gauss-Newton step from the
/// present solution: on cycles held out of that step, on strokes where there are fewer than four
/// cycles; where there are fewer than four strokes AICc decides. In the order of their scores, up
/// to four are fitted, where the paired gain of prediction is no chance (one-sided t of the
/// logarithms of the ratios of errors, with the correlation of folds, Nadeau & Bengio 2003) and
/// worth `smallest_gain`. The first is added that lowers the rms by as much, and by which the slip
/// force is not lost. The rounds end when none is added, the model is adequate, or `most_fits` are
/// made.
///
/// *Confounded terms.* A covariate is not added where it is a copy of a channel that is fitted, of
/// a candidate before it or of the velocity, or where it follows the contact's force, |r| > 0.3:
/// its factor and the slip force then share what the record shows. A lag is added where it leaves
/// at most half the squared error of the best force of speed: a lag is the same at every speed, and
/// a knee that is rounded by speed looks like one.
/// @param records  [m], [N]
/// @param options  of every fit; a term that these have is no candidate
/// @throws InvalidArgument as Fit does, for folds < 2 or a chance outside (0, 1)
/// Deterministic. Nothing is selected in a fit of the displacement.
TermSelection SelectTerms(std::span<const loop::RecordView> records, const FitOptions& options,
                          const TermSelectionOptions& selection = {});
TermSelection SelectTerms(std::span<const loop::Record> records, const FitOptions& options,
                          const TermSelectionOptions& selection = {});

/// Returns the terms that may explain what a fit misses, at most `most`, the best first: scored as
/// SelectTerms() scores its candidates, by one Gauss-Newton step; a gap that was measured comes
/// first. None of them is fitted.
/// @param options  of the fit
std::vector<std::string> LikelyTerms(std::span<const loop::RecordView> records,
                                     const FitOptions& options, const FitResult& fit,
                                     std::size_t most);

}  // namespace mindahl::identification
