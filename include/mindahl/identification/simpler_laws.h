#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::identification {

/// Holds a law fitted to a record, and its comparison with the best one. Pessimistic by
/// default.
struct LawScore {
  std::string model;             ///< name in FrictionModels() or LimitLaws()
  bool exponent_is_one = false;  ///< Dahl's law with α held at 1
  models::BranchLaw law;         ///< as fitted; a spring determines only σ, Coulomb's law only Tc
  std::size_t free_parameters = 0;
  bool converged = false;
  double rms = 0.0;               ///< [N] of the residuals; 0 where there is no fit
  double misfit = 0.0;            ///< [N] √(rms² − rms of the best²): what it lacks
  double delta_aicc = 0.0;        ///< above the best; infinite where there is no fit
  double likelihood_ratio = 0.0;  ///< 2 ln Λ of the best against it, at least 0
  /// P(χ²(k) > 2 ln Λ), k the parameters that the best has more; empty where it has none
  std::optional<double> p_value;
  /// True if the record distinguishes it from the best: ΔAICc >= Thresholds::indistinguishable.
  bool told_apart = true;
};

struct SimplerLaws {
  std::vector<LawScore> scores;    ///< simplest first
  std::size_t best = 0;            ///< with the least AICc
  std::size_t samples = 0;         ///< number that count
  double effective_samples = 0.0;  ///< n_eff of the fit with the least rms
  double peak_force = 0.0;         ///< [N] largest of the loop
  /// True if the best fit is not inadequate; otherwise residuals are mostly discrepancy, not noise.
  bool describes_record = false;
};

/// Fits a spring, Coulomb's law, Jenkins' element, Dahl's own law with α = 1 and with free α,
/// Mindlin's contact and the Masing law with free α to one record, each with the offsets of the
/// options, and says which of them the record distinguishes from the best, by the criterion of
/// model_selection.h:
///   AICc = n_eff·ln(rms²) + 2k + 2k(k+1)/(n − k − 1),      2 ln Λ = n_eff·ln(rms²/rms_best²)
/// A law that is not distinguished may replace the best for motions like the record's: its
/// misfit is within what the record's noise hides.
/// @param options  of every fit; `model` is set here, a given α leaves nothing to choose
/// @throws InvalidArgument as Fit does, where the options fix α, and where no law can be fitted
/// Deterministic. Cost: five fits at Depth::kIntervals.
SimplerLaws CompareSimplerLaws(const loop::RecordView& record, const FitOptions& options = {});

}  // namespace mindahl::identification
