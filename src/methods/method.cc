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

// Costs of operations [ns].
constexpr double kPlace = 4.1;       // to find the branch that a sample lies on
constexpr double kReversal = 100.0;  // to open a branch
constexpr double kRoot = 1.4;        // the branch law, α = 1/3: a square root and a division
constexpr double kPower = 17.0;      // the branch law, any other α: two transcendentals
constexpr double kRatePower = 31.0;  // the slope at the start of a branch of Dahl's law
constexpr double kLookUp = 2.3;      // the branch law from a table
constexpr double kElement = 0.35;    // an element of Iwan's, moved on
constexpr double kSum = 4.0;         // the sum of their forces

struct PathSize {
  double samples = 0.0;
  double branches = 0.0;

  [[nodiscard]] double cost() const { return kPlace * samples + kReversal * branches; }
};

PathSize SizeOf(const FrictionModel& model, const Drive& drive) {
  return {static_cast<double>(drive.displacement.size()),
          static_cast<double>(MakeDrivePath(model, drive).branches.size())};
}

Evaluator PrepareExact(const FrictionModel& model, const BranchLaw& law, const Resolution&) {
  return [&model, law](const Drive& drive, std::span<double> force) {
    models::EvaluateForce(model, law, MakeDrivePath(model, drive), drive.displacement, force);
  };
}

double CostOfExact(const FrictionModel& model, const BranchLaw& law, const Resolution&,
                   const Drive& drive) {
  const PathSize path = SizeOf(model, drive);
  const double start = model.memory == models::Memory::kNone ? kRatePower * path.branches : 0.0;
  if (law.shape_exponent == 0) return path.cost() + start;  // hidden by finding the branch
  const double evaluations = path.samples + path.branches;
  return path.cost() + start + (law.shape_exponent == 1.0 / 3 ? kRoot : kPower) * evaluations;
}

Evaluator PrepareDopri5(const FrictionModel& model, const BranchLaw& law,
                        const Resolution& resolution) {
  return MakeDopri5(model, law, resolution, nullptr);
}

/// Evaluates: steps depend on where the drive slips, and on the error that is found.
double CostOfDopri5(const FrictionModel& model, const BranchLaw& law, const Resolution& resolution,
                    const Drive& drive) {
  double steps = 0.0;
  std::vector<double> force(drive.displacement.size());
  MakeDopri5(model, law, resolution, &steps)(drive, force);
  return SizeOf(model, drive).cost() + steps;
}

Evaluator PrepareIwan(const FrictionModel&, const BranchLaw& law, const Resolution& resolution) {
  return [elements = MakeIwanElements(law, resolution.steps)](const Drive& drive,
                                                              std::span<double> force) {
    EvaluateIwanForce(elements, drive.displacement, force);
  };
}

double CostOfIwan(const FrictionModel&, const BranchLaw& law, const Resolution& resolution,
                  const Drive& drive) {
  constexpr std::size_t kLanes = 4;  // moved at once, filled or not
  const std::size_t elements = law.shape_exponent == 0 ? 1 : resolution.steps;
  const std::size_t moved = (elements + kLanes - 1) / kLanes * kLanes;
  return static_cast<double>(drive.displacement.size()) *
         (kElement * static_cast<double>(moved) + kSum);
}

double CostOfTable(const FrictionModel& model, const BranchLaw&, const Resolution&,
                   const Drive& drive) {
  const PathSize path = SizeOf(model, drive);
  return path.cost() + kLookUp * (path.samples + path.branches);
}

constexpr std::array kMethods{
    Method{.name = "exact", .title = "closed form", .prepare = PrepareExact, .cost = CostOfExact},
    Method{.name = "dopri5",
           .title = "Dormand-Prince 5(4), adaptive",
           .steps = "substeps a sample at least",
           .adaptive = true,
           .prepare = PrepareDopri5,
           .cost = CostOfDopri5},
    Method{.name = "iwan",
           .title = "Jenkins elements in parallel",
           .steps = "elements",
           .default_steps = 32,
           .masing_only = true,
           .prepare = PrepareIwan,
           .cost = CostOfIwan},
    Method{.name = "table",
           .title = "tabulated branch law",
           .steps = "intervals",
           .default_steps = 256,
           .prepare = PrepareTable,
           .cost = CostOfTable},
};

}  // namespace

models::LoadingPath MakeDrivePath(const FrictionModel& model, const Drive& drive) {
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

double CostOf(const Method& method, const FrictionModel& model, const BranchLaw& law,
              const Resolution& resolution, const Drive& drive) {
  Prepare(method, model, law, resolution);  // checks the arguments
  return kCostOfSample + method.cost(model, law, resolution, drive) /
                             static_cast<double>(drive.displacement.size());
}

}  // namespace mindahl::methods
