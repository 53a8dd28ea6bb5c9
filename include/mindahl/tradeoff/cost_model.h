#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "mindahl/methods/method.h"
#include "mindahl/methods/operations.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/tradeoff/approximation.h"

namespace mindahl::tradeoff {

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
