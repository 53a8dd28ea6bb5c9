#pragma once

#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/response.h"

namespace mindahl::models {

/// Returns T* [N]: force at the extremes of the steady loop between ±amplitude [m].
/// @throws InvalidArgument for an invalid law or amplitude
/// Relative error below 6 ε = 1.3e-15 for a Masing law, 16 ε for Dahl's.
double SteadyPeakForce(const FrictionModel& model, const BranchLaw& law, double amplitude);

/// Returns W [J] lost per cycle in the steady loop between ±amplitude [m]. For a Masing law
/// 8∫₀^X f dx − 4X·f(X) (Johnson 7.57 for α = 1/3), without the cancellation of the two terms at
/// small X; for the laws without memory the same integral over their own branches.
/// @throws InvalidArgument for an invalid law or amplitude, and where the energy overflows
/// Relative error below 1 ε = 2.2e-16 for every X of a Masing law, where long double has 64 bits.
/// For Dahl's own law below (16 + α) ε, for α < 0.05 and X within 10 % of the elastic limit, where
/// W is a difference of nearly equal numbers, of 4XT*.
double SteadyLoopEnergy(const FrictionModel& model, const BranchLaw& law, double amplitude);

/// Returns the part of an amplitude [m] that is the contact's where a rig in series shares in it:
///   X_c = X − T*(X_c)/k_r
/// @param amplitude  [m] of contact and rig, finite, >= 0
/// @throws InvalidArgument for an invalid law or amplitude
/// Relative error 1e-15; the amplitude itself for a rigid rig.
double ContactAmplitude(const FrictionModel& model, const BranchLaw& law, const SeriesSpring& rig,
                        double amplitude);

/// Returns Dahl's own law on whose steady loop between ±amplitude a Masing law runs: there both are
/// one curve, each with a σ and a Tc of its own (docs/theory.md §6).
///   α' = α      σ' = σ·(1 − T*/(2Tc))^α = σ·((1+u)/2)^α      Tc' = 2Tc − T* = Tc·(1+u)
/// with T* = f(X) and u = 1 − T*/Tc; in gross slip σ' = 2^{−α}·σ and Tc' = Tc, for X = 0, which is
/// a straight line, σ' = σ and Tc' = 2Tc. Peyret et al. (2017) eq. 20 is eq. 10 of these:
/// 1 − (T* + sT)/(2Tc) = (1 − T*/(2Tc))·(1 − sT/(2Tc − T*)).
/// @param amplitude  X [m] of the contact, without a rig's share (ContactAmplitude), finite, >= 0
/// @throws InvalidArgument for an invalid law or amplitude, and where 2Tc overflows
/// Relative error below (2 + α) ε of σ', below 2 ε of Tc'.
BranchLaw DahlEquivalent(const BranchLaw& masing, double amplitude);

/// Returns the Masing law that runs through the steady loop of Dahl's own law between ±amplitude:
///   α = α'      σ = σ'·(1 + T*/Tc')^α      Tc = (Tc' + T*)/2
/// the inverse of DahlEquivalent(). σ is eq. 12's slope after a reversal at T*, where a Masing
/// branch starts with the virgin stiffness.
/// @throws InvalidArgument likewise
/// Relative error below (2 + 16α) ε of σ, below 12 ε of Tc: those of T* (SteadyPeakForce).
BranchLaw MasingEquivalent(const BranchLaw& dahl, double amplitude);

}  // namespace mindahl::models
