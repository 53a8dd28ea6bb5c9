#include "mindahl/tradeoff/cost_model.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "mindahl/models/friction_model.h"
#include "mindahl/models/limit_law.h"

namespace mindahl::tradeoff {

using methods::Operation;
using methods::OperationCount;

namespace {

struct Price {
  Operation operation;
  double nanoseconds;
};

// In the order of Operation, by scripts/calibrate_costs.py.
constexpr std::array kPrices = {
    Price{Operation::kSample, 1.5},     Price{Operation::kPlace, 4.1},
    Price{Operation::kReversal, 100.0}, Price{Operation::kLinear, 0.0},  // hidden by its place
    Price{Operation::kRoot, 1.4},       Price{Operation::kPower, 17.0},
    Price{Operation::kNarrowing, 0.4},  Price{Operation::kElement, 0.35},
    Price{Operation::kSum, 4.0},        Price{Operation::kLookUp, 2.3},
    Price{Operation::kStep, 1.8},       Price{Operation::kStage, 1.8},
    Price{Operation::kTrial, 40.0},     Price{Operation::kCubicRoot, 34.0},
    Price{Operation::kRatePower, 31.0}, Price{Operation::kExponential, 34.0},
    Price{Operation::kIteration, 14.0},
};
static_assert(kPrices.size() == methods::kOperations);

}  // namespace

OperationCount CountOperations(const Approximation& approximation, const models::BranchLaw& law,
                               const methods::Drive& drive) {
  if (models::FindLimitLaw(approximation.model) != nullptr) {
    OperationCount count;
    count.Add(Operation::kSample, static_cast<double>(drive.displacement.size()));
    return count;
  }
  return methods::CountOperations(RequireMethod(approximation.method),
                                  RequireModel(approximation.model), LawOf(approximation, law),
                                  approximation.resolution, drive);
}

double PriceOf(Operation operation) {
  return std::ranges::find(kPrices, operation, &Price::operation)->nanoseconds;
}

double ModelledCost(const OperationCount& count, std::size_t samples) {
  double cost = 0.0;
  for (const Price& price : kPrices) cost += price.nanoseconds * count[price.operation];
  return cost / static_cast<double>(samples);
}

std::optional<std::size_t> CheapestOf(std::span<const double> costs,
                                      const std::function<bool(std::size_t)>& allowed) {
  constexpr double kSameCost = 1.1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (allowed(i)) least = std::min(least, costs[i]);
  }
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (allowed(i) && costs[i] <= kSameCost * least) return i;
  }
  return std::nullopt;
}

}  // namespace mindahl::tradeoff
