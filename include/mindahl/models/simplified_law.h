#pragma once

#include <span>
#include <string_view>

#include "mindahl/models/branch_law.h"

namespace mindahl::models {

/// A simplification of the contact that cannot be fitted: it lacks a parameter, or its history.
struct SimplifiedLaw {
  std::string_view name;   ///< on the command line
  std::string_view title;  ///< in reports
  /// Force [N] along a displacement [m] of a contact that was unloaded at displacement 0.
  /// @param envelope  amplitude [m] of the excitation at each sample where it changes along the
  ///   path, else empty; Simplified-Dahl alone refers to it
  /// @throws InvalidArgument for an invalid law, sizes that differ, a displacement that is not
  ///   finite, or a force beyond the largest double
  void (*evaluate_force)(const BranchLaw& law, std::span<const double> displacement,
                         std::span<const double> envelope, std::span<double> force);
};

/// - "simplified-dahl": the steady branch without a virgin phase (Peyret et al. 2017, eq. 27),
/// which
///   is Dahl's own law with the parameters of DahlEquivalent() at the amplitude (docs/theory.md
///   §7); |T| may exceed Tc. Errors as of EvaluateForce().
/// - "spring": T = σδ, the limit X ≪ δc. Dissipates nothing, is not bounded. Exact to rounding.
/// - "coulomb": T = Tc·sgn δ̇, the limit X ≫ δc. T = 0 until the first motion; at rest T keeps its
///   last value. Exact.
std::span<const SimplifiedLaw> SimplifiedLaws();

/// Returns nullptr when there is no such law.
const SimplifiedLaw* FindSimplifiedLaw(std::string_view name);

/// Returns the force [N] that Simplified-Dahl has a step [m] after it had another one: eq. 27 on
/// one monotone piece, dT/dx = σ(1 − (T* + sT)/(2Tc))^α with s the direction of the step.
/// @param peak   T* [N] of the steady loop at the amplitude
/// @param force  T [N] before
double SimplifiedDahlStep(const BranchLaw& law, double peak, double force, double step);

}  // namespace mindahl::models
