#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

/// States whether a record follows Masing's law (Mindlin's, Full-Dahl) or Dahl's own. For the same
/// loop σ and Tc of the two laws differ by factors of up to 2^α and 2.
struct LawChoice {
  /// The law that the record follows: the fitted one or `alternative`; null if undecided.
  const models::FrictionModel* preferred = nullptr;

  // The other law:
  const models::FrictionModel* alternative = nullptr;
  models::BranchLaw law;  ///< its σ, α, Tc
  /// AICc of the other law minus that of the fitted one, > 0 if the fitted one is better. Empty if
  /// the other was not fitted: on a steady loop of one amplitude both give the same curve. It may
  /// be large without a decision if they differ in a first stroke of unrecorded loading alone.
  std::optional<double> delta_aicc;

  [[nodiscard]] bool decided() const { return preferred != nullptr; }
  [[nodiscard]] bool prefers_alternative() const { return decided() && preferred == alternative; }
};

/// How the search of a fit ended, as Ceres reports it.
struct SolverReport {
  /// "tiny_solver" or "solve" (of Ceres); "none" where all that is not linear is fixed.
  std::string_view solver = "none";
  /// Ceres' termination type: CONVERGENCE, NO_CONVERGENCE, FAILURE; "not run".
  std::string_view termination = "not run";
  std::string message = "not run";  ///< Ceres' reason
  int iterations = 0;               ///< sum over all searches from this start
  double final_cost = 0.0;          ///< ½ Σ of the squared weighted residuals [N² or m²]
};

/// Sets how much of a fit is computed; each depth includes the one before.
enum class Depth {
  kEstimate,   ///< values, rms, convergence: for work that is done again and again
  kErrors,     ///< and facts of the record, noise, standard errors, intervals, correlations and
               ///< residuals as if the model were adequate, none where no loop is seen: from the
               ///< parabola of the likelihood, and from its profile where that is wrong about Tc
  kIntervals,  ///< and what repeats in the residuals, adequacy, its causes, and verdicts; intervals
               ///< cover what these would change
  kFull,       ///< and a rig in place of another α, the other law, and the fit without a first
               ///< stroke from an unrecorded turn, if all else is described: what the program asks
};

enum class ParameterStatus { kFree, kFixed, kAtLowerBound, kAtUpperBound };

struct ParameterEstimate {
  std::string name;
  std::string unit;
  double value = 0.0;
  std::optional<double> standard_error;  ///< empty when fixed, at a bound or undetermined
  std::optional<double> lower95;         ///< ends of the 95 % interval; empty where it is open
  std::optional<double> upper95;
  ParameterStatus status = ParameterStatus::kFixed;
  bool includes_discrepancy = false;    ///< true if the interval allows for the model discrepancy
  std::optional<Interval> bounds = {};  ///< those that the user gave
  Identifiability identifiability = Identifiability::kNotIdentifiable;

  /// True if the search stopped at a bound, of the user's or of the program's own.
  [[nodiscard]] bool is_at_bound() const {
    return status == ParameterStatus::kAtLowerBound || status == ParameterStatus::kAtUpperBound;
  }
  /// True if the search stopped at a bound of the user's that is not the sign alone: the value is
  /// the user's, not the record's.
  [[nodiscard]] bool is_at_given_bound() const {
    if (!is_at_bound() || !bounds) return false;
    return (status == ParameterStatus::kAtLowerBound ? bounds->lower : bounds->upper) != 0;
  }
  /// True if given, identifiable or effective.
  [[nodiscard]] bool is_known() const {
    return status == ParameterStatus::kFixed || identifiability <= Identifiability::kEffective;
  }
};

/// Returns nullptr when there is none of that name.
const ParameterEstimate* FindEstimate(const std::vector<ParameterEstimate>& parameters,
                                      std::string_view name);

/// Holds the fit of one record, and how that was read. In a fit of the displacement the noise of
/// its readings is that of the fit.
struct RecordFit : loop::RecordReading {
  /// True if its motion turns between samples, as these show it, and not at the outermost ones.
  bool turns_between = false;
  /// [m] In a fit of the displacement: where the law has the contact, offsets included; else empty.
  std::vector<double> fitted_displacement;
  std::optional<double> normal_load;  ///< mean N [N], given or of the column; empty where not known
  double load_ratio = 1.0;            ///< load over the mean load of a load series; else 1
  bool load_varies = false;           ///< within the record, if the law knows it
  /// Averages residuals by place in the stroke, sign as the displacement; from kIntervals on.
  ResidualStructure structure;
  /// [N] Fitted (measured if the displacement is fitted), with the file's sign and offsets.
  std::vector<double> fitted_force;
  /// Samples of a first stroke from a turn that is not recorded, which was left out; else 0.
  std::size_t first_stroke = 0;
  std::vector<double> residual;  ///< fitted − measured [unit of the response]
};

/// Holds the result of a fit, by default not converged; what a depth does not compute is empty.
struct FitResult {
  Depth depth = Depth::kFull;
  double confidence = 0.95;  ///< confidence of every interval
  bool converged = false;
  SolverReport solver;
  const models::FrictionModel* model = nullptr;
  /// The channel that was fitted: residuals, their rms and the misfit are in its unit, N or m.
  loop::Channel response = loop::Channel::kForce;
  models::InitialState initial_state = models::InitialState::kVirgin;
  int force_sense = 1;
  models::BranchLaw law;     ///< the fitted σ, α, Tc
  models::SeriesSpring rig;  ///< rigid where there is none
  /// Mean normal load [N], to which σ and Tc of a load series belong; empty unless all are known.
  std::optional<double> normal_load;
  double load_exponent = 1.0;  ///< p of σ ∝ N^p; 1, without meaning, if the records have one load
  double rms = 0.0;            ///< rms of the residuals that count [N or m], unweighted
  /// The rms by which fits are compared [N or m], −2 ln L = 2n·ln(likelihood_rms) + const: `rms`,
  /// but with noise of the displacement the rms of the weighted residuals over the geometric mean
  /// of the roots of their weights.
  double likelihood_rms = 0.0;
  double force_noise = 0.0;  ///< [N], known or estimated, of all records; 0 of a displacement
  std::size_t outliers = 0;  ///< samples that a robust loss gives less than half their weight
  /// Masing's law or Dahl's own; empty where they are one or σ or Tc is held, and under a model
  /// that is inadequate unless the other law is the better one.
  std::optional<LawChoice> law_choice;
  std::vector<ParameterEstimate> parameters;
  /// Correlation of the parameters in the order of `parameters`, row-major; NaN where undefined
  std::vector<double> correlation;
  ResidualStatistics residuals;
  /// Degrees of freedom of Student's distribution of the errors: effective samples less free
  /// parameters, at least 1; practically infinite where the noise is known.
  double degrees_of_freedom = 0.0;
  Adequacy adequacy;  ///< from depth kIntervals on
  std::vector<RecordFit> records;
  std::vector<Finding> findings;

  /// Returns nullptr when the fit has no such parameter.
  [[nodiscard]] const ParameterEstimate* Find(std::string_view name) const {
    return FindEstimate(parameters, name);
  }

  /// Returns a parameter of one of the records, nullptr when there is none.
  [[nodiscard]] const ParameterEstimate* FindOf(const RecordFit& record,
                                                std::string_view name) const;

  /// Returns nullptr when nothing of the code, or of its kind if one is given, was found.
  [[nodiscard]] const Finding* FindFinding(FindingCode code, std::string_view kind = {}) const;

  /// Returns the record with the largest amplitude, in a load series over N^{1−p}, to which the
  /// gross-slip displacement is in proportion: the one that comes nearest to gross slip.
  [[nodiscard]] const RecordFit& WidestRecord() const;

  /// Returns the law of a record at its mean load: σ·(N/N₀)^p, α, Tc·N/N₀.
  [[nodiscard]] models::BranchLaw LawOf(const RecordFit& record) const {
    return models::AtLoad(law, record.load_ratio, load_exponent);
  }

  /// Returns the largest step of an encoder that read a displacement [m]; 0 where none did.
  [[nodiscard]] double EncoderStep() const;

  /// Returns the largest force [N] of the widest record, as it would be at the mean load of all.
  [[nodiscard]] double PeakForce() const;

  /// True of Dahl's own law under a load that varies: its force follows the load at once, so that
  /// neither a peak nor a half gap of the measured force bounds Tc.
  [[nodiscard]] bool is_scaled_by_load() const;

  /// Returns half the gap between the strokes of the widest record [N], as it would be at the mean
  /// load of all; empty in a fit of the displacement, and where none was measured or it is not > 0.
  [[nodiscard]] std::optional<double> MeasuredHalfGap() const;

  /// Returns what a misfit is held against [N or m]: the half gap of a loop that slides or reaches
  /// slip, else T*; of a displacement its amplitude.
  [[nodiscard]] double MisfitScale() const;

  /// Returns the number of parameters that are not held, for criteria.
  [[nodiscard]] std::size_t CountFreeParameters() const;

  /// Returns the error of a parameter [its unit] in whatever follows from it: the distance to the
  /// farther end of its interval, along the logarithm of a positive parameter, in units of the half
  /// width of Student's 95 % interval; the standard error where that is larger. 0 of a parameter
  /// that is held, infinite of one whose interval is open or that has no error.
  [[nodiscard]] double ErrorOf(const ParameterEstimate& estimate) const;

  /// Returns the same towards a value that the parameter is tested against: the value is beyond the
  /// 95 % interval if and only if it lies farther away than Student's quantile of this error.
  [[nodiscard]] double ErrorTowards(const ParameterEstimate& estimate, double value) const;

  /// True if the other law was compared with the fitted one, and is preferred.
  [[nodiscard]] bool prefers_other_law() const {
    return law_choice && law_choice->prefers_alternative();
  }
  [[nodiscard]] bool is_load_series() const { return Find("load_exponent") != nullptr; }
};

/// Returns the amplitude of the contact itself [m] in a steady loop of the measured amplitude: less
/// half of a gap before it, and what a rig in series takes.
/// @param law  of the record
double ContactAmplitude(const FitResult& fit, const models::BranchLaw& law, double amplitude);

}  // namespace mindahl::identification
