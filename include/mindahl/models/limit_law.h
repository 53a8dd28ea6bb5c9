#pragma once

#include <span>
#include <string_view>

#include "mindahl/models/branch_law.h"

namespace mindahl::models {

/// Describes a limit of the branch law at either end of the amplitude: a model without a history,
/// for scenes that need no more. It cannot be fitted (each lacks a parameter) and dissipates
/// nothing or has no presliding.
struct LimitLaw {
  std::string_view name;   ///< on the command line
  std::string_view title;  ///< in reports
  /// Force [N] along a displacement [m] of a contact that was unloaded at displacement 0.
  /// @throws InvalidArgument for an invalid law, sizes that differ, a displacement that is not
  ///   finite, or a force beyond the largest double
  void (*evaluate_force)(const BranchLaw& law, std::span<const double> displacement,
                         std::span<double> force);
};

/// - "spring": T = σδ, the limit X ≪ δc. Dissipates nothing, is not bounded.
/// - "coulomb": T = Tc·sgn δ̇, the limit X ≫ δc. T = 0 until the first motion; at rest T keeps its
///   last value.
/// Exact to rounding.
std::span<const LimitLaw> LimitLaws();

/// Returns nullptr when there is no such law.
const LimitLaw* FindLimitLaw(std::string_view name);

}  // namespace mindahl::models
