#include "mindahl/tradeoff/approximation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/simplified_law.h"

namespace mindahl::tradeoff {

using methods::Method;
using methods::Resolution;
using models::BranchLaw;
using models::FrictionModel;

namespace {

/// Resolutions at which a method is tried: tolerances, or steps, which grow fourfold.
constexpr std::array kTolerances = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10};
constexpr std::size_t kFewestElements = 4;
constexpr std::size_t kFewestIntervals = 16;

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

BranchLaw LawOf(const FrictionModel& model, BranchLaw law) {
  law.shape_exponent = model.shape_exponent.value_or(law.shape_exponent);
  return law;
}

}  // namespace

std::string Describe(const Approximation& approximation) {
  if (approximation.method.empty()) return approximation.model;
  const Method& method = RequireMethod(approximation.method);
  std::string text = fmt::format("{} by {}", approximation.model, approximation.method);
  if (method.adaptive)
    return fmt::format("{}, tolerance {:g}", text, approximation.resolution.tolerance);
  if (method.steps.empty()) return text;
  return fmt::format("{}, {} {}", text, approximation.resolution.steps, method.steps);
}

methods::Evaluator Prepare(const Approximation& approximation, const BranchLaw& law) {
  if (const models::SimplifiedLaw* simple = models::FindSimplifiedLaw(approximation.model)) {
    Validate(law);
    return [simple, law](const methods::Drive& drive, std::span<double> force) {
      simple->evaluate_force(law, drive.displacement, drive.envelope, force);
    };
  }
  const FrictionModel& model = RequireModel(approximation.model);
  return Prepare(RequireMethod(approximation.method), model, LawOf(model, law),
                 approximation.resolution);
}

double CostOf(const Approximation& approximation, const BranchLaw& law,
              const methods::Drive& drive) {
  const bool is_steady_branch = approximation.model == "simplified-dahl";
  if (is_steady_branch && !drive.envelope.empty()) {
    return methods::kCostOfSample + methods::kCostOfStep;
  }
  if (!is_steady_branch && models::FindSimplifiedLaw(approximation.model) != nullptr) {
    return methods::kCostOfSample;
  }
  // Simplified-Dahl is Dahl's own law with other parameters.
  const FrictionModel& model = RequireModel(is_steady_branch ? "dahl" : approximation.model);
  return methods::CostOf(RequireMethod(approximation.method), model, LawOf(model, law),
                         approximation.resolution, drive);
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

std::vector<Approximation> AllApproximations(const BranchLaw& law) {
  std::vector<Approximation> all;
  for (const std::string_view model : {"spring", "coulomb"}) {
    all.push_back({std::string(model), ""});
  }
  for (const std::string_view model : {"jenkins", "simplified-dahl", "dahl", "mindlin"}) {
    all.push_back({std::string(model), "exact"});
  }
  const std::string exact = ExactModel(law);
  if (std::ranges::find(all, exact, &Approximation::model) == all.end()) {
    all.push_back({exact, "exact"});
  }
  for (const Method& method : methods::Methods()) {
    if (method.name == "exact") continue;
    std::size_t steps = method.masing_only ? kFewestElements : kFewestIntervals;
    for (const double tolerance : kTolerances) {
      all.push_back({exact, std::string(method.name),
                     method.adaptive ? Resolution{.tolerance = tolerance}
                                     : Resolution{.steps = std::exchange(steps, 4 * steps)}});
    }
  }
  return all;
}

}  // namespace mindahl::tradeoff
