#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mindahl/identification/residual_statistics.h"
#include "mindahl/loop/cycles.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

namespace mindahl {

struct Interval {
  double lower = 0.0;
  double upper = 0.0;
};

/// What to fit and how. Parameter names are those of the command line: sigma [N/m], alpha [-],
/// slip_force [N], force_offset [N], displacement_offset [m], force_drift [N/s, or N a sample where
/// the record has no time]. With several records the last three belong to a record each and are
/// numbered from 1: force_offset_2.
struct FitOptions {
  /// One of FrictionModels() that is not scaled_by_peak.
  const FrictionModel* model = FindFrictionModel("mindlin-dahl");

  /// Empty: both are fitted and the smaller AICc on effective samples is kept.
  std::optional<InitialState> initial_state;

  /// Offsets of force and, for a virgin contact, of displacement are free parameters; otherwise 0.
  bool offsets = true;

  /// A force drift linear in time is a free parameter; otherwise 0.
  bool drift = false;

  /// +1: force and displacement have the same sense, −1: opposite (a load cell on the other body).
  /// Empty: decided by the sign of the loop's energy.
  std::optional<int> force_sense;

  /// Excursions up to this [m] are noise and make no reversal. Empty: EstimateReversalGate.
  std::optional<double> reversal_gate;

  /// Known standard deviation of the force noise [N]; empty: from the residuals.
  std::optional<double> force_noise;

  std::map<std::string, double> fixed;     ///< parameter held at a value
  std::map<std::string, double> start;     ///< replaces the starting value found from the data
  std::map<std::string, Interval> bounds;  ///< replaces the default bounds

  /// The solver stops when |Δcost| < function_tolerance · cost …
  double function_tolerance = 1e-10;
  /// … or |Δθ| < parameter_tolerance · (|θ| + parameter_tolerance), θ non-dimensional …
  double parameter_tolerance = 1e-13;
  /// … or 20 steps together raise twice the log-likelihood by less than 1e-3 …
  /// … or it has made this many steps: then the result is not converged.
  int max_iterations = 500;

  /// Starting points refined, best first.
  std::size_t starts = 3;
};

enum class ParameterStatus { kFree, kFixed, kAtLowerBound, kAtUpperBound };

enum class Identifiability {
  kIdentifiable,
  kBoundedBelow,     ///< the data give only a lower limit
  kBoundedAbove,     ///< only an upper limit
  kNotIdentifiable,  ///< neither, or only in combination with others
};

struct ParameterEstimate {
  std::string name;
  std::string unit;
  double value = 0.0;
  std::optional<double> standard_error;  ///< empty when fixed, at a bound or undetermined
  std::optional<double> lower95;         ///< ends of the 95 % interval; empty where it is open
  std::optional<double> upper95;
  ParameterStatus status = ParameterStatus::kFixed;
  Identifiability identifiability = Identifiability::kNotIdentifiable;
};

/// A starting point and what the solver reached from it.
struct StartReport {
  BranchLaw start;
  double initial_rms = 0.0;  ///< [N]
  BranchLaw reached;
  double final_rms = 0.0;  ///< [N]
  bool converged = false;
};

struct FitWarning {
  std::string code;  ///< stable, for scripts
  std::string message;
};

/// One record as the fit sees it.
struct RecordFit {
  double reversal_gate = 0.0;          ///< [m]
  std::vector<std::size_t> reversals;  ///< samples
  /// How far the motion turned beyond the outermost sample [m], one a reversal; empty unless the
  /// record is sampled so coarsely that it had to be fitted.
  std::vector<double> overshoot;
  LoopMeasures measures;             ///< with the force in the displacement's sense
  std::vector<double> fitted_force;  ///< [N], in the file's sense, offsets included
  std::vector<double> residual;      ///< fitted − measured [N]
};

/// Pessimistic by default: a result that nobody filled in has not converged.
struct FitResult {
  bool converged = false;
  std::string termination = "not run";
  int iterations = 0;
  const FrictionModel* model = nullptr;
  InitialState initial_state = InitialState::kVirgin;
  int force_sense = 1;
  BranchLaw law;  ///< the fitted σ, α, Tc
  std::vector<ParameterEstimate> parameters;
  /// Correlation of the parameters in the order of `parameters`, row-major; NaN where undefined
  std::vector<double> correlation;
  ResidualStatistics residuals;
  std::vector<StartReport> starts;
  std::vector<RecordFit> records;
  std::vector<FitWarning> warnings;

  /// nullptr when the fit has no such parameter.
  [[nodiscard]] const ParameterEstimate* Find(std::string_view name) const;

  /// The record with the largest amplitude: the one that comes nearest to gross slip.
  [[nodiscard]] const RecordFit& WidestRecord() const;
};

/// Least-squares fit of one contact's records, with shared σ, α, Tc and offsets of their own.
///
/// Minimises Σ (T_model(δ; σ, α, Tc, δ₀) + F₀ − T)² over non-dimensional parameters (ln σ, ln Tc, α
/// and offsets over the records' ranges), so that the answer does not depend on the units. The
/// model is the closed form of docs/theory.md §5 with its exact gradient; there is no time step and
/// no sampling rule. Starting values come from a grid over (σX/Tc, α) on which Tc and the force
/// offset are linear.
/// @param records  [m], [N]; at least as many samples as free parameters
/// @throws InvalidArgument for records or options that break a rule. A fit that fails is a result
/// with
///         converged = false and the reason in `termination`.
FitResult Fit(std::span<const Record> records, const FitOptions& options);

}  // namespace mindahl
