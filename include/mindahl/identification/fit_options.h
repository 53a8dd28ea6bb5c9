#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::identification {

using loop::Interval;

/// Names the loss, which reduces the weight of large residuals (constants: reweighting.h).
enum class Loss { kNone, kHuber, kCauchy, kTukey };

/// Prior knowledge of a parameter: a normal distribution, of the logarithm if it is positive.
struct Prior {
  double value = 0.0;                 ///< in the parameter's unit
  double standard_uncertainty = 0.0;  ///< likewise, > 0
};

/// Sets what is fitted and how. Parameters have the names of Terms(); with several records those of
/// a record are numbered from 1: force_offset_2.
struct FitOptions {
  /// One of FrictionModels().
  const models::FrictionModel* model = models::FindFrictionModel("mindlin-dahl");

  /// State of the contacts before the first samples. Empty: both are fitted, the smaller AICc kept.
  std::optional<models::InitialState> initial_state{};

  /// How the records are read, and which samples count.
  loop::PreparationOptions preparation{};

  /// Offsets of force and, for a virgin contact, of displacement are free parameters; otherwise 0.
  bool offsets = true;

  /// Terms that are fitted in addition, by name: plateau_slope … Fixing one gives it a known value.
  std::vector<std::string> terms{};

  /// Columns of the records, by the names of their covariates, in proportion to which a force is
  /// added, C·(column − the middle of its range in each record; without offsets − 0). Each C is a
  /// parameter, NameOfCovariate(); fixing it gives it a known value. Every record must have them.
  std::vector<std::string> covariates{};

  /// Normal load [N] of every record, or one for all; empty: the mean of a record's column. Where
  /// records differ in it by more than Thresholds::load_change they are one contact all the
  /// same: Tc = μN, σ ∝ N^p with p the parameter load_exponent, α shared; σ and Tc are those at the
  /// mean of the records' loads.
  std::vector<double> normal_loads{};

  /// Known standard deviation of the force noise [N] of all records; empty: from the residuals, of
  /// each record where they differ in it. A force that is imposed is taken as exact and has none.
  std::optional<double> force_noise{};

  /// Fraction of such intervals, in (0, 1), that contain the true value.
  double confidence = 0.95;

  /// Its scale comes from the residuals, or is the known noise.
  Loss loss = Loss::kNone;

  std::map<std::string, double> fixed{};  ///< parameter held at a value
  /// Priors of fitted parameters: each is one more residual, (θ − θ_prior)/u relative to the noise
  /// that a fit without priors finds.
  std::map<std::string, Prior> priors{};
  std::map<std::string, double> start{};     ///< replaces the starting value found from the data
  std::map<std::string, Interval> bounds{};  ///< replaces the default bounds

  /// Steps of a search, or three times as many where it ends at a bound; after these it has failed.
  int max_iterations = 500;

  Thresholds thresholds{};

  /// Returns the channel that is fitted, whose noise the residuals are: that which is not imposed.
  [[nodiscard]] loop::Channel response() const { return loop::Other(preparation.excitation); }
  /// Returns the known standard deviation of its noise [N or m]; empty: from the residuals.
  [[nodiscard]] std::optional<double> response_noise() const {
    return response() == loop::Channel::kForce ? force_noise : preparation.displacement_noise;
  }
};

/// Refuses options that break a rule whatever the records are.
/// @throws InvalidArgument naming the option, its value and the rule
void Validate(const FitOptions& options);

}  // namespace mindahl::identification
