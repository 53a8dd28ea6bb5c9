#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::identification {

/// A model fitted to all samples that count, with its scores. By default it has none.
struct ModelScore {
  const models::FrictionModel* model = nullptr;
  bool rig = false;  ///< with a fitted spring in series
  std::size_t free_parameters = 0;
  double rms = 0.0;         ///< rms of the scored samples [N]
  double delta_aicc = 0.0;  ///< above the least
  /// rms error [N] of the prediction of held-out cycles; empty without such or where a fit failed.
  std::optional<double> held_out_rms = {};
};

/// Fits every model that needs no amplitude (Masing–Dahl with free α, Mindlin, Jenkins, Dahl's own
/// law) to the same records, each without and with a rig in series. The choice is the user's.
///
/// *Criterion*, for k free parameters and the variance of the noise:
///   AICc = n_eff·ln(rms²) + 2k + 2k(k+1)/(n − k − 1),      n_eff: ResidualStatistics
/// Akaike (1974) and Hurvich & Tsai (1989), by the independent samples of the candidate with the
/// least rms: autocorrelated residuals of a poor model must not count in its favour.
///
/// *Prediction.* Closed cycles, of records that have two or more, are dealt in turn to at most five
/// folds, each predicted by fits to the rest; samples held out still make history.
///
/// @param options  of every fit; `model` and the term rig_stiffness are set here. A fixed rig
///                 stiffness belongs to all candidates; a fixed α leaves out models that prescribe
///                 another
/// @returns each model whose fit converged, without and with a rig, in the order of
/// FrictionModels()
/// @throws InvalidArgument as Fit does, or for a fit of the displacement
/// Deterministic. Cost: 8 fits at Depth::kIntervals, and from there 8 a fold at Depth::kEstimate.
std::vector<ModelScore> CompareModels(std::span<const loop::Record> records,
                                      const FitOptions& options);

}  // namespace mindahl::identification
