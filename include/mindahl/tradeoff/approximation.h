#pragma once

#include <string>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::tradeoff {

/// A way to compute the force of a contact along a drive: a model, and a method that evaluates it.
struct Approximation {
  std::string model;   ///< a name of FrictionModels() or LimitLaws()
  std::string method;  ///< a name of Methods(); "" for a limit law, which has but one
  methods::Resolution resolution = {};
};

/// In words: "mindlin by rk4, 4 substeps a sample".
std::string Describe(const Approximation& approximation);

/// The law as the approximation's model uses it: α is the model's where that prescribes one.
models::BranchLaw LawOf(const Approximation& approximation, const models::BranchLaw& law);

/// The approximation made ready for a contact.
/// @throws InvalidArgument for an unknown model or method, or as Prepare() of methods/method.h
methods::Evaluator Prepare(const Approximation& approximation, const models::BranchLaw& law);

/// The Masing law with the contact's α, by the name under which it is cheapest: "mindlin" for
/// α = 1/3, "jenkins" for α = 0, else "mindlin-dahl".
std::string ExactModel(const models::BranchLaw& law);

/// The models a contact may be simplified to, simplest first, each in closed form: spring, coulomb,
/// jenkins, simplified-dahl, dahl, mindlin, mindlin-dahl. Those that are the contact's own law are
/// named once.
std::vector<Approximation> ModelLadder(const models::BranchLaw& law);

/// The exact model by every method, from coarse to fine.
std::vector<Approximation> MethodLadder(const models::BranchLaw& law);

/// ModelLadder, then what of MethodLadder is not in it: each way once.
std::vector<Approximation> AllApproximations(const models::BranchLaw& law);

}  // namespace mindahl::tradeoff
