#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Names the condition under which a parameter is fitted.
enum class Presence {
  kAlways,      ///< unless it is fixed
  kOffsets,     ///< with FitOptions::offsets; held at 0 otherwise, and reported
  kReported,    ///< if requested; otherwise 0, and reported
  kOnDemand,    ///< if requested or fixed; otherwise absent
  kLoadSeries,  ///< if the records have different loads; otherwise absent
  kNever,       ///< never: it belongs to fits of the other channel
};

/// The units in which a fit works, for the records' numbers to be of order one.
struct TermUnits {
  double force = 1.0;                   ///< [N]
  double length = 1.0;                  ///< [m]
  double half_duration = 1.0;           ///< [s], or samples where the record has no time
  double cycle = 1.0;                   ///< [s], or samples: of the record's cycles, on average
  double force_sense = 1.0;             ///< ±1: the force's sign in the file
  double force_reference = 0.0;         ///< [N], subtracted from the record's force
  double displacement_reference = 0.0;  ///< [m], likewise
  double speed = 1.0;                   ///< velocity [m/s] that is scaled to one
  double reference_speed = 1.0;         ///< scaled: its mean in the middle third of the strokes
};

/// The powers of a fit's units in the unit of a parameter.
struct TermScale {
  int force = 0;
  int length = 0;
  int time = 0;          ///< of half a record
  int cycle = 0;         ///< time in cycles
  bool of_file = false;  ///< with the force's sign in the file
};

/// The rows of the table, in their order, which is the order of the parameters of a fit.
enum class TermId : std::size_t {
  kSigma,
  kAlpha,
  kSlipForce,
  kRigStiffness,
  kLoadExponent,
  kAsymmetry,
  kPlateauSlope,
  kViscous,
  kSpeedExponent,
  kInertia,
  kSlipSlope,
  kSlipCurvature,
  kSlipSpeed,
  kSlipSpeedExponent,
  kSlipTrend,
  kDragFraction,
  kDragExponent,
  kPlateauCurvature,
  kRipplePeriod,
  kRippleCosineUp,
  kRippleSineUp,
  kRippleCosineDown,
  kRippleSineDown,
  kLag,
  kBacklash,
  kCovariate,
  kForceOffset,
  kDisplacementOffset,
  kForceDrift,
  kDisplacementDrift,
};

/// Describes a parameter of a fit for layout, solver, command line, help and documents. A new one
/// is a row of the table in terms.cc.
///   value = scale·exp(θ) where positive,  else  value = reference + scale·θ
struct Term {
  TermId id{};
  std::string_view name;
  std::string_view unit = "-";
  std::string_view meaning;  ///< one line, for tables of the documents
  /// One parameter a record, numbered from 1 (force_offset_2); else one of the contact, for all.
  bool is_of_record = false;
  Presence presence = Presence::kOnDemand;
  bool positive = false;
  double lowest = -10.0;  ///< default bounds, in units of the data
  double highest = 10.0;
  TermScale powers = {};
  /// The factor of a column (problem/problem.h); others enter through the law or the path.
  bool is_linear = false;
  bool needs_time = false;
  /// θ at which a search may begin, of a parameter that is not linear.
  std::optional<double> start = {};
  /// How the names of the linear parameters begin whose columns depend on this one.
  std::string_view shapes = {};
  /// Name of the term without which this one cannot be fitted; empty: none.
  std::string_view needs = {};
  /// The default bound is the theory's: Jenkins' α, no gap. At the others a search is cut short.
  bool lowest_is_of_theory = false;
  bool highest_is_of_theory = false;
  bool is_never_negative = false;  ///< a mass or a damping that is stands for something else
  /// One parameter for each column that FitOptions::covariates names, called after it.
  bool of_column = false;
  std::string_view unit_by_sample = {};  ///< unit in records without time; empty: the same

  /// True of the factor of a force in addition to the contact's.
  [[nodiscard]] constexpr bool adds_force() const {
    return is_linear && presence != Presence::kAlways && presence != Presence::kOffsets;
  }
  /// Returns the scale of the values, in the unit of the parameter.
  [[nodiscard]] double scale(const TermUnits& units) const;
  /// Returns the value at θ = 0 of one that is not positive, likewise.
  [[nodiscard]] double reference(const TermUnits& units) const;
};

/// Returns all parameters of a fit of `response`, in the order in which they are reported: the
/// contact's, then a record's. They are the same, in the same places, for either response: of a
/// displacement that answers a force the compliance 1/σ is linear, Tc enters the law, the force's
/// offset is where the contact is unloaded, and what adds to the contact's force has no place.
std::span<const Term> Terms(loop::Channel response = loop::Channel::kForce);

/// Returns the row of an id.
const Term& TermOf(TermId id, loop::Channel response = loop::Channel::kForce);

/// Returns nullptr when there is none of that name, which is without a record's number.
const Term* FindTerm(std::string_view name, loop::Channel response = loop::Channel::kForce);

/// Returns the term of a parameter of a result, numbered or of a column; nullptr if there is none.
const Term* TermOfParameter(std::string_view parameter);

/// A term, or a few that belong together, that a record may require.
struct TermGroup {
  std::string_view name;
  std::vector<std::string_view> terms;  ///< names in FitOptions::terms; the first one leads it
  std::string_view meaning;             ///< in a line of the help
  bool is_tried = true;                 ///< false if it is added only where it is named
};

/// Returns the terms that can be added, apart from covariates; `--terms` takes these names.
std::span<const TermGroup> TermGroups();

/// True if it is the first of a group: the others come with it.
bool LeadsGroup(const Term& term);

/// Returns nullptr where there is none of that name.
const TermGroup* FindTermGroup(std::string_view name);

/// Returns the name without a record's number: force_offset for force_offset_2.
std::string_view TermNameOf(std::string_view parameter);

/// Returns the name of the parameter of a column: covariate_COLUMN, with '_' for what would need
/// quoting in options and paths (blanks, '=', ':', ',', '.', brackets and quotes).
std::string NameOfCovariate(std::string_view column);

}  // namespace mindahl::identification
