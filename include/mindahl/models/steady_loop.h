#pragma once

#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"

namespace mindahl {

/// T* [N]: force at the extremes of the steady loop between ±amplitude [m].
/// @throws InvalidArgument for an invalid law or amplitude
double SteadyPeakForce(const FrictionModel& model, const BranchLaw& law, double amplitude);

/// W [J] lost per cycle in the steady loop between ±amplitude [m].
/// For a Masing law 8∫₀^X f dx − 4X·f(X) (Johnson 7.57 for α = 1/3), without the cancellation of
/// the two terms at small X; for the laws without memory the same integral over their own branches.
/// Relative error below 1e-14 for every X.
/// @throws InvalidArgument for an invalid law or amplitude
double SteadyLoopEnergy(const FrictionModel& model, const BranchLaw& law, double amplitude);

/// Energy ratio A = W/(4·X·T*) at the onset of gross slip of a Masing law: α/(2−α), 0.2 for
/// Mindlin, the fretting community's limit between partial and gross slip (Fouvry). NaN-free: 1 for
/// α >= 1, where slip is only approached.
double GrossSlipEnergyRatio(double shape_exponent);

}  // namespace mindahl
