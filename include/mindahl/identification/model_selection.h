#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::identification {

/// Sets how the choice between models is made.
struct SelectionOptions {
  /// Parts into which the cycles are divided for prediction; fewer where there are fewer cycles.
  std::size_t folds = 5;
};

/// A model fitted to all samples that count, with its scores. By default it has none.
struct ModelScore {
  const models::FrictionModel* model = nullptr;
  bool rig = false;  ///< with a fitted spring in series
  std::size_t free_parameters = 0;
  double rms = 0.0;            ///< rms of the scored samples [N]
  double aicc = 0.0;           ///< infinite where there is no fit
  double delta_aicc = 0.0;     ///< above the least of the converged fits
  double akaike_weight = 0.0;  ///< exp(−ΔAICc/2) over its sum; 0 where not converged
  /// Root mean square error [N] of the prediction of cycles that were held out; empty where there
  /// is nothing to hold out, a fit without them failed, or the candidate is redundant.
  std::optional<double> held_out_rms;
  std::optional<double> held_out_standard_error;  ///< [N], from the scatter between cycles
  bool converged = false;
  /// True if a free parameter is at a bound, where the law turns into another one.
  bool at_bound = false;
  /// True if a simpler candidate is the same: the rig is rigid, or α is 0.
  bool redundant = false;
  std::string remark;  ///< comment on this fit; may be empty
};

struct ModelSelection {
  /// Each model without, then with a rig, in the order of FrictionModels()
  std::vector<ModelScore> scores;
  std::size_t chosen = 0;  ///< index into `scores`
  /// Indices into `scores`, simplest first: the chosen model and all indistinguishable from it.
  std::vector<std::size_t> indistinguishable;
  double effective_samples = 0.0;   ///< n_eff of the criterion
  std::size_t held_out_cycles = 0;  ///< each was predicted once; 0 where there are too few
  std::size_t folds = 0;
  FitResult fit;  ///< the chosen one
  std::string verdict;
};

/// Fits every model that needs no amplitude (Masing–Dahl with free α, Mindlin, Jenkins, Dahl's own
/// law) to the same records, each without and with a spring of the rig in series, and chooses one.
///
/// *Criterion*, for k free parameters and the variance of the noise:
///   AICc = n_eff·ln(rms²) + 2k + 2k(k+1)/(n − k − 1),      n_eff: ResidualStatistics
/// Akaike (1974) and Hurvich & Tsai (1989) but for n_eff, which weighs the likelihood: residuals
/// that are autocorrelated, or repeat in every stroke, carry less information. n_eff is that of the
/// candidate with the least rms, for all: a poor model's residuals are autocorrelated, which must
/// not count in its favour. Differences of rms below the rounding of the data are none.
///
/// *Prediction.* Whole cycles, from one reversal to the next but one, are dealt to the folds in
/// turn; each fold is predicted by fits to the rest that start from the full fit, the samples held
/// out still making history. Records with fewer than two closed cycles are never held out.
///
/// *Choice.* The least AICc among converged fits; but those within Thresholds::indistinguishable of
/// it whose mean square error of prediction is not larger by a standard error of the difference
/// (paired over cycles) are indistinguishable from it, and the simplest of these is reported:
/// fewest free parameters, then rigid, then the least AICc. Without held-out cycles AICc alone
/// decides. Candidates that are redundant or at a bound are listed, but not chosen while there are
/// others.
///
/// With a robust loss, samples that the best candidate puts beyond 4.685 robust standard deviations
/// are not scored in any.
/// @param options  of every fit; `model` and the term rig_stiffness are set here. A fixed rig
///                 stiffness belongs to all candidates; a fixed α leaves out models that prescribe
///                 another
/// @throws InvalidArgument as Fit does, for folds < 2, a largest ΔAICc that is negative, or a fit
///   of the displacement
/// Deterministic. Cost: 8 fits at Depth::kIntervals, 8 a fold at Depth::kEstimate from where these
/// are, and the chosen one at Depth::kFull.
ModelSelection SelectModel(std::span<const loop::RecordView> records, const FitOptions& options,
                           const SelectionOptions& selection = {});
ModelSelection SelectModel(std::span<const loop::Record> records, const FitOptions& options,
                           const SelectionOptions& selection = {});

}  // namespace mindahl::identification
