#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// A candidate and what it gained in the last round in which it was tried.
struct ConsideredTerm {
  std::string name;  ///< name of the group, or NameOfCovariate()
  /// Fraction by which it would reduce the rms of the residuals, to first order [–].
  double gain = 0.0;
  bool added = false;
  /// Reason why it was not added: "", of one that gains "confounded", "unphysical" or
  /// "not_converged", of a column that repeats another one "same_channel".
  std::string_view obstacle;
};

enum class MostTerms {
  kTwo,     ///< one after the other
  kCommon,  ///< or all that measured loops have in common
};

struct TermSelection {
  std::vector<ConsideredTerm> considered = {};  ///< those added first, in order; then by gain
  std::vector<std::string> added = {};
  FitOptions options;  ///< with the terms that were added
  FitResult fit = {};  ///< with them
};

/// Fits a record with the terms that it requires (docs/identification.md): none where the law
/// describes it adequately; else as many as `most` says. Candidates are scored by one Gauss–Newton
/// step from the present solution (term_scores.h) and added by the gain of their fits.
/// @param records  [m], [N]
/// @param options  of every fit; a term that these have is no candidate
/// @param fit      of the records with the options, at Depth::kFull
/// @throws InvalidArgument as Fit does
/// Deterministic. Nothing is selected in a fit of the displacement.
TermSelection SelectTerms(std::span<const loop::RecordView> records, const FitOptions& options,
                          FitResult fit, MostTerms most = MostTerms::kCommon);

/// Returns the terms that explain what a fit misses, the one that leaves least first: the `most`
/// that score best as SelectTerms() scores its candidates, a column that follows the force before
/// all, are fitted at Depth::kEstimate, and those with an obstacle to them left out.
/// @param options  of the fit
std::vector<std::string> LikelyTerms(std::span<const loop::RecordView> records,
                                     const FitOptions& options, const FitResult& fit,
                                     std::size_t most);

/// Extends the closed intervals of σ and α to the values and the closed ends of another fit of the
/// record, with a term that describes it better, and judges the parameters again. Tc is held by the
/// measured half gap, and is another force beside some of the terms.
void IncludeFit(const FitResult& with_term, const Thresholds& thresholds, FitResult& fit);

}  // namespace mindahl::identification
