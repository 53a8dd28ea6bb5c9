#pragma once

#include <optional>
#include <span>

#include "identification/inference/noise.h"
#include "identification/problem/scaled_records.h"
#include "identification/solve/search.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::identification {

/// Holds the inputs of a fit while it is made.
struct Attempt {
  const FitOptions& options;  // with drawn readings of the records
  Depth depth;
  const loop::PreparedRecords& prepared;
  ScaledRecords& data;
};

/// Holds the least squares of some records: what every later stage starts from.
struct SolvedFit {
  Candidate best;  ///< best of the initial states that were tried
  Noise noise = {};
  bool is_settled = true;  ///< the weights are those of the residuals that they leave
  /// Holds the law of the other initial state, where it is nearly as likely.
  std::optional<models::BranchLaw> of_other_state = {};

  [[nodiscard]] const Solution& solution() const { return best.solution; }
};

/// Returns the records of a fit in its units, with the force's sign and the turns that it found.
/// @param with  options whose terms' columns the records have
/// @throws InvalidArgument as the fit would
ScaledRecords ScaledAsFitted(std::span<const loop::RecordView> records, FitOptions options,
                             const FitOptions& with, const FitResult& fit);

/// Fits from the initial state that the options name, or that Akaike's criterion prefers. Samples
/// are weighted where the displacement is inexact or the loss is robust.
/// @throws InvalidArgument for too few samples, or an asymmetry that the record cannot distinguish
SolvedFit SolveFit(const Attempt& attempt);

/// Masing's law against Dahl's own, whichever was fitted, by AICc on the effective samples of the
/// one that leaves less. The other is fitted too where the record may distinguish them, from where
/// its loop at the widest amplitude is the same; of one amplitude it follows in closed form.
/// @param data  the records, scaled
/// @param fit   of them, from Depth::kErrors on
/// @returns empty where the laws are one (α = 0), and where they are not compared
std::optional<LawChoice> CompareLaws(std::span<const loop::RecordView> records,
                                     const FitOptions& options, const ScaledRecords& data,
                                     const FitResult& fit);

}  // namespace mindahl::identification
