#include "mindahl/tradeoff/work_precision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/refuse.h"
#include "mindahl/loop/facts.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/simplified_law.h"

namespace mindahl::tradeoff {

using methods::Drive;
using methods::Method;
using methods::Resolution;
using models::BranchLaw;

namespace {

constexpr const char* kExactModel = "mindlin-dahl";

/// Samples [first, last] of a cycle that closes.
using ClosedCycle = std::pair<std::size_t, std::size_t>;

/// Returns the cycles along a path that close, in their order, none within another: from a turning
/// point back to it, to 5 % of the width between, and in between not beyond the turning point
/// before it, so that force and stored energy return too. Of the first, that is its image through
/// the unloaded contact.
std::vector<ClosedCycle> ClosedCycles(std::span<const double> displacement) {
  constexpr double kReturns = 0.05;
  std::vector<double> path = {0.0};  // where the contact is unloaded
  path.insert(path.end(), displacement.begin(), displacement.end());
  std::vector<std::size_t> turns = loop::FindReversals(path, 0.0);
  turns.push_back(path.size() - 1);
  // Returns the place from which the path is back at a turning point, 0 where it never is.
  const auto end_of = [&](std::size_t begin) -> std::size_t {
    const double at = path[turns[begin]];
    const double before = begin == 0 ? -at : path[turns[begin - 1]];
    const double sense = at > before ? 1.0 : -1.0;
    double width = 0.0;
    for (std::size_t k = begin + 1; k < turns.size(); ++k) {
      const double below = sense * (at - path[turns[k]]);
      const bool is_opposite = (k - begin) % 2 == 1;
      width = std::max(width, below);
      const double tolerance = kReturns * width;
      if (below < -tolerance || below > sense * (at - before) + tolerance) return 0;
      if (!is_opposite && below <= tolerance) return k;
    }
    return 0;
  };
  std::vector<ClosedCycle> cycles;
  for (std::size_t begin = 0; begin + 2 < turns.size();) {
    const std::size_t end = end_of(begin);
    if (end > 0) cycles.emplace_back(turns[begin] - 1, turns[end] - 1);
    begin = end > 0 ? end : begin + 1;
  }
  return cycles;
}

}  // namespace

methods::Evaluator Prepare(const Approximation& approximation, const BranchLaw& law) {
  if (approximation.model == models::kSimplifiedDahl) {
    Validate(law);
    return [law](const Drive& drive, std::span<double> force) {
      // It is Dahl's own law with other parameters, and under an envelope a branch each step.
      constexpr double kStep = 139.3;  // [ns]
      const double cost = drive.envelope.empty() ? Prepare({"dahl", "exact"}, law)(drive, force)
                                                 : kStep * static_cast<double>(force.size());
      models::EvaluateSimplifiedDahl(law, drive.displacement, drive.envelope, force);
      return cost;
    };
  }
  const models::FrictionModel* model = models::FindFrictionModel(approximation.model);
  const Method* method = methods::FindMethod(approximation.method);
  if (model == nullptr || method == nullptr) {
    Refuse<InvalidArgument>("there is no model '{}' or no method '{}'", approximation.model,
                            approximation.method);
  }
  BranchLaw of_model = law;
  of_model.shape_exponent = model->shape_exponent.value_or(law.shape_exponent);
  return Prepare(*method, *model, of_model, approximation.resolution);
}

std::vector<Approximation> AllApproximations() {
  std::vector<Approximation> all;
  for (const char* model : {"jenkins", "simplified-dahl", "dahl", kExactModel}) {
    all.push_back({model, "exact"});
  }
  for (const Method& method : methods::Methods()) {
    if (method.name == "exact") continue;
    std::size_t steps = method.masing_only ? 4 : 16;  // elements, intervals: grow fourfold
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
      all.push_back({kExactModel, std::string(method.name),
                     method.adaptive ? Resolution{.tolerance = tolerance}
                                     : Resolution{.steps = std::exchange(steps, 4 * steps)}});
    }
  }
  return all;
}

Precision Compare(std::span<const double> exact, std::span<const double> displacement,
                  std::span<const double> force) {
  double peak = 0.0;
  for (const double at : exact) peak = std::max(peak, std::abs(at));
  Precision precision;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double error = std::abs(force[i] - exact[i]) / (peak > 0 ? peak : 1.0);
    precision.max_force = std::max(precision.max_force, error);
  }
  double exact_energy = 0.0;  // lost over the cycles that close
  double energy = 0.0;
  for (const auto& [first, last] : ClosedCycles(displacement)) {
    exact_energy += loop::CycleEnergy({displacement, exact}, first, last);
    energy += loop::CycleEnergy({displacement, force}, first, last);
  }
  if (exact_energy != 0) precision.energy = std::abs(energy / exact_energy - 1);
  return precision;
}

std::vector<WorkPrecision> MeasureWorkPrecision(const BranchLaw& law, const Drive& drive) {
  std::vector<double> exact(drive.displacement.size());
  Prepare({kExactModel, "exact"}, law)(drive, exact);
  std::vector<WorkPrecision> points;
  std::vector<double> force(exact.size());
  for (const Approximation& approximation : AllApproximations()) {
    constexpr double kSample = 1.5;  // [ns], to read a displacement and to write a force
    const double cost = Prepare(approximation, law)(drive, force);
    points.push_back({.approximation = approximation,
                      .precision = Compare(exact, drive.displacement, force),
                      .cost = kSample + cost / static_cast<double>(force.size())});
  }
  return points;
}

std::size_t CheapestWithin(double tolerance, std::span<const WorkPrecision> points) {
  if (!(tolerance > 0 && tolerance <= 1)) {
    ThrowInvalid("tolerance [-]", tolerance, "must be in (0, 1]");
  }
  constexpr double kSameCost = 1.1;
  const auto is_within = [&](const WorkPrecision& point) {
    return point.precision.max_force <= tolerance &&
           point.precision.energy.value_or(0) <= tolerance;
  };
  double least = std::numeric_limits<double>::infinity();
  for (const WorkPrecision& point : points) {
    if (is_within(point)) least = std::min(least, point.cost);
  }
  const auto cheapest = std::ranges::find_if(points, [&](const WorkPrecision& point) {
    return is_within(point) && point.cost <= kSameCost * least;
  });
  return static_cast<std::size_t>(cheapest - points.begin());
}

}  // namespace mindahl::tradeoff
