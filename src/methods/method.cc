#include "mindahl/methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "methods/path_methods.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/methods/iwan.h"
#include "mindahl/models/response.h"

namespace mindahl::methods {

using models::BranchLaw;
using models::FrictionModel;

namespace {

Evaluator PrepareExact(const FrictionModel& model, const BranchLaw& law, const Resolution&) {
  return [&model, law](const Drive& drive, std::span<double> force) {
    models::EvaluateForce(model, law, MakeDrivePath(model, drive), drive.displacement, force);
  };
}

void CountExact(const FrictionModel& model, const BranchLaw& law, const Resolution&,
                const Drive& drive, OperationCount& count) {
  const auto branches = static_cast<double>(CountPath(model, drive, count).branches.size());
  const Operation branch_law = LawOperation(law.shape_exponent);
  count.Add(branch_law, static_cast<double>(drive.displacement.size()) + branches);
  // The steady peak, and the rate of a branch that starts with another stiffness.
  if (model.scaled_by_peak) count.Add(branch_law, branches);
  if (model.memory == models::Memory::kNone) count.Add(Operation::kRatePower, branches);
}

void CountIwan(const FrictionModel&, const BranchLaw& law, const Resolution& resolution,
               const Drive& drive, OperationCount& count) {
  constexpr std::size_t kLanes = 4;  // moved at once, filled or not
  const std::size_t elements = law.shape_exponent == 0 ? 1 : resolution.steps;
  const std::size_t moved = (elements + kLanes - 1) / kLanes * kLanes;
  count.Add(Operation::kElement,
            static_cast<double>(drive.displacement.size()) * static_cast<double>(moved));
  count.Add(Operation::kSum, static_cast<double>(drive.displacement.size()));
}

template <IwanSpacing spacing>
Evaluator PrepareIwan(const FrictionModel&, const BranchLaw& law, const Resolution& resolution) {
  return [elements = MakeIwanElements(law, resolution.steps, spacing)](const Drive& drive,
                                                                       std::span<double> force) {
    EvaluateIwanForce(elements, drive.displacement, force);
  };
}

template <StepMethod make>
Evaluator PrepareSteps(const FrictionModel& model, const BranchLaw& law,
                       const Resolution& resolution) {
  return make(model, law, resolution, nullptr);
}

/// Counts on the way: steps depend on where the drive slips, and on the error that is found.
template <StepMethod make>
void CountSteps(const FrictionModel& model, const BranchLaw& law, const Resolution& resolution,
                const Drive& drive, OperationCount& count) {
  CountPath(model, drive, count);
  std::vector<double> force(drive.displacement.size());
  make(model, law, resolution, &count)(drive, force);
}

constexpr std::array kMethods{
    Method{.name = "exact", .title = "closed form", .prepare = PrepareExact, .count = CountExact},
    Method{.name = "euler",
           .title = "explicit Euler",
           .steps = "substeps a sample",
           .order = 1,
           .prepare = PrepareSteps<MakeEuler>,
           .count = CountSteps<MakeEuler>},
    Method{.name = "rk4",
           .title = "Runge-Kutta of order 4",
           .steps = "substeps a sample",
           .order = 4,
           .prepare = PrepareSteps<MakeRk4>,
           .count = CountSteps<MakeRk4>},
    Method{.name = "dopri5",
           .title = "Dormand-Prince 5(4), adaptive",
           .steps = "substeps a sample at least",
           .adaptive = true,
           .order = 5,
           .prepare = PrepareSteps<MakeDopri5>,
           .count = CountSteps<MakeDopri5>},
    Method{.name = "backward-euler",
           .title = "implicit Euler",
           .steps = "substeps a sample",
           .order = 1,
           .prepare = PrepareSteps<MakeBackwardEuler>,
           .count = CountSteps<MakeBackwardEuler>},
    Method{.name = "exponential",
           .title = "exponential Rosenbrock-Euler",
           .steps = "substeps a sample",
           .order = 2,
           .prepare = PrepareSteps<MakeExponential>,
           .count = CountSteps<MakeExponential>},
    Method{.name = "iwan",
           .title = "Iwan, equal slip forces",
           .steps = "elements",
           .default_steps = 32,
           .masing_only = true,
           .order = 1,
           .prepare = PrepareIwan<IwanSpacing::kEqualForce>,
           .count = CountIwan},
    Method{.name = "iwan-optimal",
           .title = "Iwan, optimal spacing",
           .steps = "elements",
           .default_steps = 32,
           .masing_only = true,
           .order = 2,
           .prepare = PrepareIwan<IwanSpacing::kOptimal>,
           .count = CountIwan},
    Method{.name = "table",
           .title = "tabulated branch law",
           .steps = "intervals",
           .default_steps = 256,
           .order = 2,
           .prepare = PrepareTable,
           .count = CountTable},
};

}  // namespace

models::LoadingPath MakeDrivePath(const FrictionModel& model, const Drive& drive) {
  if (!drive.envelope.empty() && model.scaled_by_peak) {
    return models::MakeEnvelopePath(drive.displacement, drive.envelope, 0.0);
  }
  return models::MakeLoadingPath(drive.displacement, loop::FindReversals(drive.displacement, 0.0),
                                 model.memory, {.state = models::InitialState::kVirgin});
}

std::span<const Method> Methods() { return kMethods; }

const Method* FindMethod(std::string_view name) {
  const auto method = std::ranges::find(kMethods, name, &Method::name);
  return method == kMethods.end() ? nullptr : &*method;
}

Evaluator Prepare(const Method& method, const FrictionModel& model, const BranchLaw& law,
                  const Resolution& resolution) {
  Validate(law);
  if (resolution.steps == 0) ThrowInvalid("steps [-]", 0.0, "must be >= 1");
  RequirePositive("tolerance [-]", resolution.tolerance);
  if (method.adaptive && resolution.tolerance < kLeastTolerance) {
    ThrowInvalid("tolerance [-]", resolution.tolerance,
                 fmt::format("must be >= {:g}, or rounding alone exceeds it", kLeastTolerance));
  }
  if (method.masing_only && model.memory != models::Memory::kReturnPoint) {
    throw InvalidArgument(fmt::format(
        "method {} cannot compute model {}: its elements remember every reversal, the model does "
        "not",
        method.name, model.name));
  }
  return [evaluate = method.prepare(model, law, resolution)](const Drive& drive,
                                                             std::span<double> force) {
    RequireSameSize("displacement", drive.displacement.size(), "force", force.size());
    evaluate(drive, force);
  };
}

std::string_view NameOf(Operation operation) {
  constexpr std::array<std::string_view, kOperations> kNames = {
      "sample",     "place",      "reversal",    "linear",   "root",  "power",
      "element",    "sum",        "look_up",     "step",     "stage", "trial",
      "cubic_root", "rate_power", "exponential", "iteration"};
  return kNames[static_cast<std::size_t>(operation)];
}

OperationCount CountOperations(const Method& method, const models::FrictionModel& model,
                               const models::BranchLaw& law, const Resolution& resolution,
                               const Drive& drive) {
  OperationCount count;
  // Prepare() checks the arguments.
  const Evaluator evaluate = Prepare(method, model, law, resolution);
  method.count(model, law, resolution, drive, count);
  count.Add(Operation::kSample, static_cast<double>(drive.displacement.size()));
  return count;
}

}  // namespace mindahl::methods
