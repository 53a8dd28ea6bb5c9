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

struct TermSelection {
  std::vector<ConsideredTerm>
      considered;  ///< those added first, in their order; then by their gain
  std::vector<std::string> added;
  FitOptions options;  ///< with the terms that were added
  FitResult fit;       ///< with them
};

/// Fits a record with the terms that it requires.
///
/// A record that the law describes adequately gets none: its fit stays as it is. Otherwise up to
/// two terms are added, one after the other, until hardly more than white noise is left. Every
/// candidate for which there are data is scored by one Gauss-Newton step from the present solution;
/// it may be added if it lowers the rms by 3 % or more, and if chance makes any candidate do so
/// with a probability below 5 %. The best of these is fitted, or a candidate that has only a part
/// of its terms and gains at least half as much. It is added unless its fit does not converge,
/// gains less than 3 %, ends at a bound or moves Tc away from the half gap; then the next one is
/// tried. Where more than noise is left, all terms that measured loops have in common are fitted
/// together; they replace those two under the same rules.
///
/// *Confounded terms.* A covariate is not added where it is a copy of a channel that is fitted, of
/// a candidate before it, or where it follows the contact's force, |r| > 0.3: its factor and the
/// slip force then share what the record shows. No term is added with which Tc of a loop that
/// slides leaves the half gap that was measured, unless it leaves nothing but noise.
/// @param records  [m], [N]
/// @param options  of every fit; a term that these have is no candidate
/// @param fit      of the records with the options, at Depth::kFull
/// @throws InvalidArgument as Fit does
/// Deterministic. Nothing is selected in a fit of the displacement.
TermSelection SelectTerms(std::span<const loop::RecordView> records, const FitOptions& options,
                          FitResult fit);

/// Returns the terms that explain what a fit misses, the one that leaves least first: the `most`
/// that score best as SelectTerms() scores its candidates, a column that follows the force before
/// all, are fitted at Depth::kEstimate, and those with an obstacle to them left out.
/// @param options  of the fit
std::vector<std::string> LikelyTerms(std::span<const loop::RecordView> records,
                                     const FitOptions& options, const FitResult& fit,
                                     std::size_t most);

}  // namespace mindahl::identification
