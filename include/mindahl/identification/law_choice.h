#pragma once

#include <optional>

#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::identification {

/// Masing's law (Mindlin's, Full-Dahl) or Dahl's own: which of the two a record is of. σ and Tc are
/// those of a law, and the two differ in them by up to 2^α and 2 where the loop is the same.
struct LawChoice {
  /// True if the record distinguishes them.
  bool decided = false;
  /// The law that the record is of: the fitted one or `alternative`; null where undecided.
  const models::FrictionModel* preferred = nullptr;

  // The other law:
  const models::FrictionModel* alternative = nullptr;
  models::BranchLaw law;  ///< its σ, α, Tc
  /// ΔAICc of the other law less the fitted one: positive where the fitted one is better. Empty
  /// where the other was not fitted: on a steady loop of one amplitude the two are one curve.
  std::optional<double> delta_aicc;
  std::optional<double> likelihood_ratio;  ///< 2 ln Λ of the fitted law against the other
};

}  // namespace mindahl::identification
