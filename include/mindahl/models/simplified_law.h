#pragma once

#include <span>
#include <string_view>

#include "mindahl/models/branch_law.h"

namespace mindahl::models {

/// On the command line.
inline constexpr std::string_view kSimplifiedDahl = "simplified-dahl";

/// Computes the force [N] of Simplified-Dahl, a contact that cannot be fitted as it lacks its
/// history: the steady branch without a virgin phase (Peyret et al. 2017, eq. 27), which is Dahl's
/// own law with the parameters of DahlEquivalent() at the amplitude (docs/theory.md §7); |T| may
/// exceed Tc.
/// @param displacement  [m] of a contact that was unloaded at displacement 0
/// @param envelope      amplitude [m] of the excitation at each sample where it changes along the
///                      path, else empty
/// @throws InvalidArgument for an invalid law, sizes that differ or a displacement not finite
/// Errors as of EvaluateForce().
void EvaluateSimplifiedDahl(const BranchLaw& law, std::span<const double> displacement,
                            std::span<const double> envelope, std::span<double> force);

/// Returns the force [N] that Simplified-Dahl has a step [m] after it had another one: eq. 27 on
/// one monotone piece, dT/dx = σ(1 − (T* + sT)/(2Tc))^α with s the direction of the step.
/// @param peak   T* [N] of the steady loop at the amplitude
/// @param force  T [N] before
double SimplifiedDahlStep(const BranchLaw& law, double peak, double force, double step);

}  // namespace mindahl::models
