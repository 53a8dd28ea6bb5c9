#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/terms.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

/// True if a fit has a term that is on demand, fitted or at a given value.
bool HasTerm(const FitOptions& options, std::string_view name);
bool HasTerm(const FitOptions& options, TermId id);

/// Refuses a term of the other channel.
void RequirePlace(const Term& term, loop::Channel response);

/// Says on which side of its bounds a parameter lies.
enum class BoundSide { kInside, kLower, kUpper };

/// A term of one fit, as the solver sees it: θ, non-dimensional and of order one.
///   value = scale·exp(θ) where the term is positive,  else  value = reference + scale·θ
struct Parameter {
  const Term* term = nullptr;
  std::size_t record = 0;
  std::size_t column = 0;  // of a covariate, among those of ScaledRecords
  CovariateColumn covariate = {};
  double reference = 0.0;
  double scale = 1.0;
  double theta = 0.0;  // where it is fixed
  double lower = 0.0;  // of θ
  double upper = 0.0;
  bool fixed = false;
  bool bounded_by_user = false;
  bool lower_is_of_theory = false;  // of this record, whatever the term's
  bool started_by_user = false;     // θ is where the search starts
  bool absent = false;              // a term that was not asked for: not reported
  bool confounded = false;          // held at 0, as an offset that is fitted says the same
  bool assumed = false;  // held, not where the file has its zero, but where the record begins

  /// θ of a prior, and the root weight of θ's difference from it, one more residual; 0: no prior.
  double prior_theta = 0.0;
  double prior_root_weight = 0.0;

  [[nodiscard]] bool has_prior() const { return prior_root_weight > 0; }
  /// True if the data alone say what it is.
  [[nodiscard]] bool is_open() const { return !fixed && !has_prior(); }
  /// Returns θ moved into the bounds.
  [[nodiscard]] double Clamp(double at_theta) const { return std::clamp(at_theta, lower, upper); }
  [[nodiscard]] double ToValue(double at_theta) const {
    return term->positive ? scale * std::exp(at_theta) : reference + scale * at_theta;
  }
  [[nodiscard]] double ToTheta(double value) const {
    return term->positive ? std::log(value / scale) : (value - reference) / scale;
  }
  [[nodiscard]] double BoundOn(BoundSide side) const {
    return side == BoundSide::kLower ? lower : upper;
  }
};

/// The one definition of "at a bound": within 1e-9 of the bounds' distance, which counts as 1 to
/// 1000. A parameter that is held lies inside.
BoundSide SideOf(const Parameter& parameter, double theta);

/// True if the bound of this side is the program's own: neither the user's, nor the theory's.
bool IsSearchLimit(const Parameter& parameter, BoundSide side);

/// Returns the position of a term of the contact that is not a covariate's, the same in every fit.
constexpr std::size_t RowOf(TermId id) { return static_cast<std::size_t>(id); }
inline constexpr std::size_t kStiffness = RowOf(TermId::kSigma);
inline constexpr std::size_t kShape = RowOf(TermId::kAlpha);
inline constexpr std::size_t kSlipForce = RowOf(TermId::kSlipForce);
inline constexpr std::size_t kRig = RowOf(TermId::kRigStiffness);
inline constexpr std::size_t kSpring = RowOf(TermId::kPlateauSlope);
inline constexpr std::size_t kLoadExponent = RowOf(TermId::kLoadExponent);
inline constexpr std::size_t kAsymmetry = RowOf(TermId::kAsymmetry);

/// Returns the term of where a contact is unloaded: the offset of the channel that is imposed.
constexpr TermId OriginId(loop::Channel excitation) {
  return excitation == loop::Channel::kForce ? TermId::kForceOffset : TermId::kDisplacementOffset;
}

/// True of a term that moves the contact away from the displacement at the time of the force.
constexpr bool MovesContact(TermId id) { return id == TermId::kLag || id == TermId::kBacklash; }

/// All parameters of a fit: the contact's in the order of Terms(), then each record's.
class Parameters {
 public:
  /// @throws InvalidArgument for names, values and bounds of `options` that break a rule
  Parameters(const ScaledRecords& data, const FitOptions& options,
             models::InitialState initial_state);

  [[nodiscard]] std::size_t size() const { return parameters_.size(); }
  [[nodiscard]] const Parameter& operator[](std::size_t i) const { return parameters_[i]; }
  [[nodiscard]] auto begin() const { return parameters_.begin(); }
  [[nodiscard]] auto end() const { return parameters_.end(); }

  /// Returns θ of all, where they are held or where a search may begin.
  [[nodiscard]] std::vector<double> Theta() const;
  /// Positions of the free ones.
  [[nodiscard]] const std::vector<std::size_t>& free() const { return free_; }
  /// Σ of the squared residuals of the priors.
  [[nodiscard]] double PriorCost(std::span<const double> theta) const;
  /// Positions of those that a result reports.
  [[nodiscard]] const std::vector<std::size_t>& reported() const { return reported_; }
  /// Returns the place of a record's reference position, in the imposed channel.
  [[nodiscard]] std::size_t PositionOfOrigin(std::size_t record) const {
    return PositionOf(OriginId(excitation_), record);
  }
  /// Returns the place of the contact's term, or of a record's; size() without any covariate.
  [[nodiscard]] std::size_t PositionOf(TermId id, std::size_t record = 0) const;
  [[nodiscard]] bool has_rig() const { return !parameters_[kRig].absent; }
  /// Returns the place of the term that moves the contact, of which there is one at most; size()
  /// where there is none.
  [[nodiscard]] std::size_t PositionOfMotion() const;

  /// Returns the name in options and results, numbered where there are several records.
  [[nodiscard]] std::string NameOf(std::size_t i) const;

  /// Returns the unit of its value: by sample where records have no time, and a column's own.
  [[nodiscard]] std::string UnitOf(std::size_t i) const;

  /// Holds one more parameter at θ.
  void Fix(std::size_t i, double theta);

  /// σ, α, Tc in SI.
  [[nodiscard]] models::BranchLaw LawAt(std::span<const double> theta) const;
  /// p of σ ∝ N^p; 1 where the records are under one load.
  [[nodiscard]] double LoadExponentAt(std::span<const double> theta) const {
    return parameters_[kLoadExponent].absent ? 1.0 : theta[kLoadExponent];
  }
  /// Returns the spring in series with the contact, in SI; rigid where it is absent.
  [[nodiscard]] models::SeriesSpring RigAt(std::span<const double> theta) const;

 private:
  void ApplyLimits(const FitOptions& options, bool is_steady);
  void ApplyGuesses(const FitOptions& options, double prior_noise);
  void Sort();
  /// @param what  it is, in a message
  [[nodiscard]] Parameter& Find(std::string_view name, std::string_view what);

  std::vector<Parameter> parameters_;
  std::vector<std::size_t> free_;
  std::vector<std::size_t> reported_;
  std::size_t records_;
  bool is_timed_;
  loop::Channel excitation_;
};

}  // namespace mindahl::identification
