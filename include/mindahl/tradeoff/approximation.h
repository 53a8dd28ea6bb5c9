#pragma once

#include <string>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::tradeoff {

/// A way to compute the force of a contact along a drive: a model, and a method that evaluates it.
struct Approximation {
  std::string model;   ///< a name of FrictionModels() or SimplifiedLaws()
  std::string method;  ///< a name of Methods(); "" for a spring and for Coulomb's law
  methods::Resolution resolution = {};
};

/// Returns "mindlin by table, 64 intervals", "spring".
std::string Describe(const Approximation& approximation);

/// Returns the approximation made ready for a contact, with the model's α where it prescribes one.
/// @throws InvalidArgument for an unknown model or method, or as Prepare() of methods/method.h
methods::Evaluator Prepare(const Approximation& approximation, const models::BranchLaw& law);

/// Returns the cost [ns/sample] along a drive: methods::CostOf(), of a limit law that of a sample.
/// @throws InvalidArgument as Prepare()
double CostOf(const Approximation& approximation, const models::BranchLaw& law,
              const methods::Drive& drive);

/// Returns the Masing law with the contact's α, by the name under which it is cheapest: "mindlin"
/// for α = 1/3, "jenkins" for α = 0, else "mindlin-dahl".
std::string ExactModel(const models::BranchLaw& law);

/// Returns the models a contact may be simplified to, simplest first, each in closed form (spring,
/// coulomb, jenkins, simplified-dahl, dahl, mindlin, and the contact's own, named once), then that
/// one by every other method, from coarse to fine.
std::vector<Approximation> AllApproximations(const models::BranchLaw& law);

}  // namespace mindahl::tradeoff
