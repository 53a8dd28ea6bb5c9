#pragma once

#include <cstddef>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/tradeoff/approximation.h"
#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::tradeoff {

/// Refits the models of ModelLadder that are not the contact's own law: with the σ and Tc that suit
/// a drive best instead of the contact's, and Dahl's law with α = 1 besides, in the same order:
///   min Σ (T_model(σ, Tc) − T)²   over the samples from `first` on
/// What a user gets who fits the simpler model to the contact's loop rather than to its parameters:
/// on a steady loop of one amplitude Dahl's law then errs by rounding alone (docs/theory.md §6).
/// Each minimum is looked for within a hundred times the contact's own σ/Tc to either side.
/// @param law        of the contact
/// @param reference  MakeReferenceResponse() of it along the drive
/// @param first      sample from which errors count
/// @returns approximations with a law of their own; none of a model that the drive does not move,
///   or whose best force has the wrong sign
/// @throws InvalidArgument for an invalid law or drive, or where `first` is not a sample
/// Cost: about a hundred evaluations of each model along the drive.
std::vector<Approximation> RefittedLadder(const models::BranchLaw& law, const methods::Drive& drive,
                                          const ReferenceResponse& reference,
                                          std::size_t first = 0);

/// Returns AllApproximations with refitted models, each after that at the contact's parameters.
std::vector<Approximation> AllApproximationsAlong(const models::BranchLaw& law,
                                                  const methods::Drive& drive,
                                                  const ReferenceResponse& reference,
                                                  std::size_t first = 0);

}  // namespace mindahl::tradeoff
