#pragma once

#include <span>

#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/response.h"

namespace mindahl::models {

/// Computes the tangential displacement [m] of a contact at each sample of an imposed force: exact,
/// no time step, the inverse of EvaluateForce for a contact that starts unloaded, T = 0 at δ = 0.
///
///   δ = δᵣ + s·y(|T − Tᵣ|/(span·v·Tc))/k + T/k_r,   y(φ) = (1 − u^{1−α})/(1 − α),  u = 1 − φ
///
/// with (v, span, k) the model's BranchScale on the branch from Tᵣ. α = 1/3 on the virgin branch
/// and between ±T* are eqs 6, 8 and 9 of Peyret et al. (2017). T and δ turn together, so that
/// Madelung's rules hold of forces as they do of displacements (docs/theory.md §5).
/// @param model         any of FrictionModels() that is not scaled by the peak
/// @param law           its α is used as it stands, also for a model that prescribes one
/// @param force         T [N], |T| < Tc <= 1e307 N: at Tc the contact slides, and no displacement
///   belongs to the force. The force may jump: between samples it is taken to be monotone
/// @param displacement  δ [m], written; same size; within ±1e307
/// @param rig           spring in series, rigid unless given; δ is that of both
/// @throws InvalidArgument for an invalid law or spring, an empty history, sizes that differ, a
///   model that is scaled by the peak: it refers to the amplitude of an imposed displacement; and
///   naming the sample for a force that is not below Tc, by more than rounding for Dahl's law, or a
///   displacement beyond 1e307 m, which α > 1 comes to before slip
/// A branch has a relative error below (6 + |1 − α|·|ln u|) ε, as T → 0 and next to slip too; for
/// Dahl's law also what a change of T by 2 ε·Tc makes. After reversals these add up. Cost: one
/// power a sample and a branch, a cubic root for α = 1/3, none for α = 0; 60 bytes a reversal.
void EvaluateDisplacement(const FrictionModel& model, const BranchLaw& law,
                          std::span<const double> force, std::span<double> displacement,
                          const SeriesSpring& rig = {});

}  // namespace mindahl::models
