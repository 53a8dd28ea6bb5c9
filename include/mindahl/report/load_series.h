#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/fit.h"

namespace mindahl::report {

/// A theory of how the stiffness follows the load, against the fitted exponent p.
struct LoadHypothesis {
  std::string_view name;                  ///< "sphere", "elements", "cone", "flat_punch" or "rough"
  double exponent = 0.0;                  ///< that it has; of elements in parallel the fitted α
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
  std::optional<identification::RecordAlone> alone = {};  ///< what the record says by itself
};

struct LoadSeries {
  std::vector<ContactUnderLoad> contacts;  ///< one a record, in their order
  std::vector<LoadHypothesis> hypotheses;  ///< in the order of the table of docs/theory.md §9
};

/// What a fit of records under several loads says of the contact at each; empty where the fit is of
/// one load.
///   ln σ(N) = ln σ + p·ln(N/N₀): its error is that of both, with their correlation
/// @param fit    one that did not fail
/// @param known  of the contact; its normal load is not looked at
std::optional<LoadSeries> DescribeLoadSeries(const identification::FitResult& fit,
                                             const contact::KnownContact& known);

}  // namespace mindahl::report
