#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/fit.h"

namespace mindahl::report {

/// Compares a theory of how the stiffness follows the load with the fitted exponent p.
struct LoadHypothesis {
  std::string_view name;                  ///< "sphere", "elements", "cone", "flat_punch" or "rough"
  double exponent = 0.0;                  ///< predicted p; for elements in parallel the fitted α
  std::optional<double> difference = {};  ///< p less that; empty where p was held
  std::optional<double> z = {};        ///< over its standard error; empty unless p is identifiable
  std::optional<double> p_value = {};  ///< two-sided, of Student's t
};

/// The contact at the load of one record, from the whole series.
struct ContactUnderLoad {
  double normal_load = 0.0;                                    ///< N [N], the mean of the record
  contact::UncertainValue stiffness;                           ///< σ [N/m] = σ(N₀)·(N/N₀)^p
  contact::UncertainValue slip_force;                          ///< Tc [N] = μN
  std::optional<contact::UncertainValue> contact_radius = {};  ///< a [m] = σG*/8; needs G*
  std::optional<double> hertz_radius = {};  ///< Hertz's a [m]; needs materials and radii
  std::optional<identification::RecordAlone> alone = {};  ///< values from this record alone
};

/// Holds a quantity of the contact that follows from a law of the load: ρ [m], G* [1/Pa], …
struct QuantityUnderLaw {
  std::string_view key;      ///< "equivalent_radius"
  std::string_view unit;     ///< "m"
  std::string label;         ///< "equivalent radius"
  std::string_view formula;  ///< "ρ = 4E*a³/(3N)"
  contact::PropagatedValue value;
  /// 95 %, of the fit's widened as that of σ is, and of what is known besides it; empty where the
  /// error is open, or all that it follows from is held. Of E without an upper end, infinite, where
  /// a rigid body would do as well.
  std::optional<identification::Interval> interval95;
  /// Value predicted from known properties without the fit; empty where they do not suffice.
  std::optional<double> predicted;
};

/// A theory that the series does not reject, assumed at all its loads.
struct LoadLaw {
  std::string_view name;                                ///< name of its hypothesis
  double exponent = 0.0;                                ///< p that is held
  contact::UncertainValue stiffness;                    ///< σ [N/m] at the mean load, with p held
  std::optional<identification::Interval> stiffness95;  ///< empty where it was held
  std::vector<QuantityUnderLaw> quantities;
  std::string unidentified;  ///< inputs that more would need, in a sentence; may be empty
};

struct LoadSeries {
  std::vector<ContactUnderLoad> contacts;  ///< one a record, in their order
  std::vector<LoadHypothesis> hypotheses;  ///< in the order of the table of docs/theory.md §9
  /// Hypotheses that are not rejected at kSignificance, in their order; where p was held, those
  /// with that exponent, to three digits. Empty where σ or p is not identifiable.
  std::vector<LoadLaw> laws;
};

/// True if a load series denies Hertz's law: p = 1/3 is rejected, or p was held at another value.
/// Then no ρ and no pressure follow from a contact radius.
bool DeniesHertz(const identification::FitResult& fit);

/// Describes the contact at each load of a fit of records under several loads; empty where the fit
/// is of one load.
///   ln σ(N) = ln σ + p·ln(N/N₀): its error is that of both, with their correlation
/// @param fit    one that did not fail
/// @param known  of the contact; its normal load is not looked at
std::optional<LoadSeries> DescribeLoadSeries(const identification::FitResult& fit,
                                             const contact::KnownContact& known);

}  // namespace mindahl::report
