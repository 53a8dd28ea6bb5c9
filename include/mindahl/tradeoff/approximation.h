#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::tradeoff {

/// A way to compute the force of a contact along a drive: a model, and a method that evaluates it.
struct Approximation {
  std::string model;   ///< a name of FrictionModels() or LimitLaws()
  std::string method;  ///< a name of Methods(); "" for a limit law, which has but one
  methods::Resolution resolution = {};
  /// Parameters of its own, where it was fitted to a drive (refit.h); else the contact's.
  std::optional<models::BranchLaw> law = std::nullopt;
};

/// @throws InvalidArgument where there is none of that name
const models::FrictionModel& RequireModel(std::string_view name);
const methods::Method& RequireMethod(std::string_view name);

/// Returns "mindlin by rk4, 4 substeps a sample", "dahl by exact, refitted at alpha 0.333".
std::string Describe(const Approximation& approximation);

/// Returns the law as the approximation's model uses it: its own, or the contact's, with the
/// model's α where that prescribes one.
models::BranchLaw LawOf(const Approximation& approximation, const models::BranchLaw& law);

/// Returns the approximation made ready for a contact.
/// @throws InvalidArgument for an unknown model or method, or as Prepare() of methods/method.h
methods::Evaluator Prepare(const Approximation& approximation, const models::BranchLaw& law);

/// Returns the Masing law with the contact's α, by the name under which it is cheapest: "mindlin"
/// for α = 1/3, "jenkins" for α = 0, else "mindlin-dahl".
std::string ExactModel(const models::BranchLaw& law);

/// Returns the models a contact may be simplified to, simplest first, each in closed form: spring,
/// coulomb, jenkins, simplified-dahl, dahl, mindlin, mindlin-dahl. Those that are the contact's own
/// law are named once.
std::vector<Approximation> ModelLadder(const models::BranchLaw& law);

/// Returns the exact model by every method, from coarse to fine.
std::vector<Approximation> MethodLadder(const models::BranchLaw& law);

/// Returns ModelLadder, then the members of MethodLadder that are not in it.
std::vector<Approximation> AllApproximations(const models::BranchLaw& law);

/// Counts an approximation's operations along a drive; of a limit law, the samples.
/// @throws InvalidArgument as Prepare()
methods::OperationCount CountOperations(const Approximation& approximation,
                                        const models::BranchLaw& law, const methods::Drive& drive);

/// Returns the price [ns] of an operation on the machine that docs/tradeoff.md names: a regression
/// of measured times on the counts.
double PriceOf(methods::Operation operation);

/// Returns the cost [ns/sample] by the counts and their prices: the same on every machine and in
/// every run, and in proportion to what another machine takes as far as that is built alike.
double ModelledCost(const methods::OperationCount& count, std::size_t samples);

/// Returns the cheapest of those that are allowed, the first of equals: costs within a tenth of
/// each other are equal, since no machine is known better, and the simpler stand before the others.
/// @returns nothing where none is allowed
std::optional<std::size_t> CheapestOf(std::span<const double> costs,
                                      const std::function<bool(std::size_t)>& allowed);

}  // namespace mindahl::tradeoff
