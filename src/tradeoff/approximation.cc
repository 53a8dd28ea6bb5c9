#include "mindahl/tradeoff/approximation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string_view>

#include "mindahl/core/error.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::tradeoff {

using methods::Method;
using methods::Resolution;
using models::BranchLaw;
using models::FrictionModel;

namespace {

constexpr std::array kSubsteps = {1, 2, 4, 8, 16, 32, 64};
constexpr std::array kFewSubsteps = {1, 2, 4, 8, 16};
constexpr std::array kElements = {4, 16, 64, 256};
constexpr std::array kIntervals = {16, 64, 256, 1024, 4096};
constexpr std::array kTolerances = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10};

/// Returns the resolutions at which a method is tried.
std::vector<Resolution> Resolutions(const Method& method) {
  std::vector<Resolution> resolutions;
  const auto add_steps = [&](const auto& steps) {
    for (const int count : steps) {
      resolutions.push_back({.steps = static_cast<std::size_t>(count)});
    }
  };
  if (method.adaptive) {
    for (const double tolerance : kTolerances) resolutions.push_back({.tolerance = tolerance});
  } else if (method.steps.empty()) {
    resolutions.push_back({});
  } else if (method.masing_only) {
    add_steps(kElements);
  } else if (method.default_steps > 1) {
    add_steps(kIntervals);
  } else if (method.order > 2) {
    add_steps(kFewSubsteps);
  } else {
    add_steps(kSubsteps);
  }
  return resolutions;
}

/// Returns the noun for `count` steps; the plural is the first word of `steps`, as "elements".
std::string CountedNoun(const Method& method, std::size_t count) {
  std::string noun(method.steps);
  if (count == 1) noun.erase(std::min(noun.find(' '), noun.size()) - 1, 1);
  return noun;
}

}  // namespace

const FrictionModel& RequireModel(std::string_view name) {
  const FrictionModel* model = models::FindFrictionModel(name);
  if (model == nullptr) throw InvalidArgument(fmt::format("there is no model '{}'", name));
  return *model;
}

const Method& RequireMethod(std::string_view name) {
  const Method* method = methods::FindMethod(name);
  if (method == nullptr) throw InvalidArgument(fmt::format("there is no method '{}'", name));
  return *method;
}

std::string Describe(const Approximation& approximation) {
  if (approximation.method.empty()) {
    return approximation.model + (approximation.law ? ", refitted" : "");
  }
  const Method& method = RequireMethod(approximation.method);
  std::string text = fmt::format("{} by {}", approximation.model, approximation.method);
  if (method.adaptive) {
    text += fmt::format(", tolerance {:g}", approximation.resolution.tolerance);
    if (approximation.resolution.steps == 1) return text;  // as many as it likes
  }
  if (!method.steps.empty()) {
    text += fmt::format(", {} {}", approximation.resolution.steps,
                        CountedNoun(method, approximation.resolution.steps));
  }
  if (approximation.law) {
    text += ", refitted";
    if (!RequireModel(approximation.model).shape_exponent) {
      text += fmt::format(" at alpha {:.3g}", approximation.law->shape_exponent);
    }
  }
  return text;
}

BranchLaw LawOf(const Approximation& approximation, const BranchLaw& law) {
  BranchLaw result = approximation.law.value_or(law);
  const FrictionModel* model = models::FindFrictionModel(approximation.model);
  if (model != nullptr && model->shape_exponent) result.shape_exponent = *model->shape_exponent;
  return result;
}

methods::Evaluator Prepare(const Approximation& approximation, const BranchLaw& law) {
  if (const models::LimitLaw* limit = models::FindLimitLaw(approximation.model)) {
    const BranchLaw own = LawOf(approximation, law);
    Validate(own);
    return [limit, own](const methods::Drive& drive, std::span<double> force) {
      limit->evaluate_force(own, drive.displacement, force);
    };
  }
  return Prepare(RequireMethod(approximation.method), RequireModel(approximation.model),
                 LawOf(approximation, law), approximation.resolution);
}

std::string ExactModel(const BranchLaw& law) {
  for (const FrictionModel& model : models::FrictionModels()) {
    if (model.memory == models::Memory::kReturnPoint &&
        model.shape_exponent == law.shape_exponent) {
      return std::string(model.name);
    }
  }
  return "mindlin-dahl";
}

std::vector<Approximation> ModelLadder(const BranchLaw& law) {
  std::vector<Approximation> ladder;
  for (const models::LimitLaw& limit : models::LimitLaws())
    ladder.push_back({std::string(limit.name), ""});
  for (const std::string_view model : {"jenkins", "simplified-dahl", "dahl", "mindlin"}) {
    ladder.push_back({std::string(model), "exact"});
  }
  const std::string exact = ExactModel(law);
  if (std::ranges::find(ladder, exact, &Approximation::model) == ladder.end()) {
    ladder.push_back({exact, "exact"});
  }
  return ladder;
}

std::vector<Approximation> MethodLadder(const BranchLaw& law) {
  std::vector<Approximation> ladder;
  for (const Method& method : methods::Methods()) {
    for (const Resolution& resolution : Resolutions(method)) {
      ladder.push_back({ExactModel(law), std::string(method.name), resolution});
    }
  }
  return ladder;
}

std::vector<Approximation> AllApproximations(const BranchLaw& law) {
  std::vector<Approximation> all = ModelLadder(law);
  for (const Approximation& approximation : MethodLadder(law)) {
    if (approximation.method != "exact") all.push_back(approximation);
  }
  return all;
}

using methods::Operation;
using methods::OperationCount;

namespace {

struct Price {
  Operation operation;
  double nanoseconds;
};

// In the order of Operation, by scripts/calibrate_costs.py.
constexpr std::array kPrices = {
    Price{Operation::kSample, 1.5},       Price{Operation::kPlace, 4.1},
    Price{Operation::kReversal, 100.0},   Price{Operation::kLinear, 0.0},  // hidden by its place
    Price{Operation::kRoot, 1.4},         Price{Operation::kPower, 17.0},
    Price{Operation::kElement, 0.35},     Price{Operation::kSum, 4.0},
    Price{Operation::kLookUp, 2.3},       Price{Operation::kStep, 1.8},
    Price{Operation::kStage, 1.8},        Price{Operation::kTrial, 40.0},
    Price{Operation::kCubicRoot, 34.0},   Price{Operation::kRatePower, 31.0},
    Price{Operation::kExponential, 34.0}, Price{Operation::kIteration, 14.0},
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
