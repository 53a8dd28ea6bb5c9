#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mindahl/identification/residual_statistics.h"
#include "mindahl/identification/residual_structure.h"
#include "mindahl/loop/cycles.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

struct Interval {
  double lower = 0.0;
  double upper = 0.0;
};

/// What large residuals count: as they are, or less (sample_weights.h has the constants).
enum class Loss { kNone, kHuber, kCauchy, kTukey };

/// What to fit and how. Parameter names are those of the command line: sigma [N/m], alpha [-],
/// slip_force [N], rig_stiffness [N/m], plateau_slope [N/m], force_offset [N], displacement_offset
/// [m], force_drift [N/s, or N a sample where the record has no time]. With several records the
/// last three belong to a record each and are numbered from 1: force_offset_2.
struct FitOptions {
  /// One of FrictionModels() that is not scaled_by_peak.
  const models::FrictionModel* model = models::FindFrictionModel("mindlin-dahl");

  /// Empty: both are fitted and the smaller AICc on effective samples is kept.
  std::optional<models::InitialState> initial_state;

  /// Offsets of force and, for a virgin contact, of displacement are free parameters; otherwise 0.
  bool offsets = true;

  /// A force drift linear in time is a free parameter; otherwise 0.
  bool drift = false;

  /// A spring in series with the contact, the rig's own, is a free parameter: the displacement is
  /// then that of contact and rig, δ = x + T/k_r. Fixing rig_stiffness gives a known one; else the
  /// rig is rigid.
  bool fit_rig_stiffness = false;

  /// A force that grows with the displacement beside the contact's, T + slope·δ, is a free
  /// parameter: a sloped plateau. Otherwise 0.
  bool plateau_slope = false;

  /// The force follows the measured normal load, T·N/mean N: σ, α and Tc are those at the mean
  /// load. The displacement at which the contact slips is taken not to change: for loads that vary
  /// by some per cent. Needs the load of every record.
  bool follow_load = false;

  /// Samples under another load [N] do not count; they still make history.
  std::optional<Interval> load_window;

  /// Cycles at the start of each record that do not count; they still make history.
  std::size_t skip_cycles = 0;

  /// Samples that do not count, one vector a record, each empty or one entry a sample; they still
  /// make history.
  std::vector<std::vector<bool>> held_out;

  /// +1: force and displacement have the same sense, −1: opposite (a load cell on the other body).
  /// Empty: decided by the sign of the loop's energy.
  std::optional<int> force_sense;

  /// Excursions up to this [m] are noise and make no reversal. Empty: EstimateReversalGate, and at
  /// least what a known displacement noise reaches, 2√(2 ln n) standard deviations.
  std::optional<double> reversal_gate;

  /// Known standard deviation of the force noise [N]; empty: from the residuals.
  std::optional<double> force_noise;

  /// Known standard deviation of the displacement noise [m], white. Empty: estimated where the
  /// record shows it by its gate or by an encoder's steps of 1e-3 of its half range, else 0. A
  /// noisy displacement is smoothed (DisplacementSmoother), since noise in the argument of a curved
  /// law is a bias; what errors are left are drawn again and again to weigh the samples and for the
  /// standard errors. docs/coverage.md says how well that does.
  std::optional<double> displacement_noise;

  /// Its scale comes from the residuals, or is the known noise.
  Loss loss = Loss::kNone;

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

  /// Starting points refined, best first: from a grid over the data, of which there are up to four,
  /// and beyond them drawn at random.
  std::size_t starts = 3;
  std::uint64_t seed = 1;  ///< of those
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

/// α as one kind of branch tells it, the other parameters shared: a departure from one law shows
/// where it is. Linearised about the fit.
struct BranchShape {
  std::string branch;  ///< "virgin", "unloading" or "reloading"
  std::size_t samples = 0;
  double shape_exponent = 0.0;
  double standard_error = 0.0;
};

/// α = 1/3 against the fitted α, the other parameters fitted again.
struct MindlinTest {
  double likelihood_ratio = 0.0;  ///< twice its logarithm, for residuals as they hang together
  double p_value = 1.0;           ///< of F(1, degrees of freedom)
  /// Stiffness [N/m] of a rig in series with which α = 1/3 fits as well as the fitted α without, by
  /// ΔAICc < 4: then the record does not tell a contact of another shape from Mindlin's in a rig
  /// that gives way. Looked for where α = 1/3 is rejected at 5 %, α is smaller and no rig is
  /// fitted.
  std::optional<double> rig_stiffness;
};

/// A starting point and what the solver reached from it.
struct StartReport {
  bool drawn = false;  ///< at random, not from the grid
  models::BranchLaw start;
  double initial_rms = 0.0;  ///< [N]
  models::BranchLaw reached;
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
  std::vector<std::size_t> reversals;  ///< samples; of a noisy record after smoothing
  /// How far the motion turned beyond the outermost sample [m], one a reversal; empty unless the
  /// record is sampled so coarsely that it had to be fitted.
  std::vector<double> overshoot;
  loop::LoopMeasures measures;       ///< with the force in the displacement's sense
  double displacement_noise = 0.0;   ///< [m] of the readings; 0 where they count as exact
  std::size_t left_out = 0;          ///< samples that do not count
  ResidualStructure structure;       ///< of the residuals, in the displacement's sense
  std::vector<double> fitted_force;  ///< [N], in the file's sense, offsets included
  std::vector<double> residual;      ///< fitted − measured [N]
};

/// Pessimistic by default: a result that nobody filled in has not converged.
struct FitResult {
  bool converged = false;
  std::string termination = "not run";
  int iterations = 0;
  const models::FrictionModel* model = nullptr;
  models::InitialState initial_state = models::InitialState::kVirgin;
  int force_sense = 1;
  models::BranchLaw law;     ///< the fitted σ, α, Tc
  models::SeriesSpring rig;  ///< rigid where there is none
  double force_noise = 0.0;  ///< [N], known or estimated
  std::size_t outliers = 0;  ///< samples that a robust loss gives less than half their weight
  std::optional<MindlinTest> mindlin_test;  ///< empty where α is held or not determined
  std::vector<BranchShape> branch_shapes;  ///< α of each branch on its own; empty where α is held
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
FitResult Fit(std::span<const loop::Record> records, const FitOptions& options);

}  // namespace mindahl::identification
