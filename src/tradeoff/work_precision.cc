#include "mindahl/tradeoff/work_precision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/simplified_law.h"

namespace mindahl::tradeoff {

using methods::Drive;
using methods::Method;
using methods::Resolution;
using models::BranchLaw;
using models::FrictionModel;

namespace {

constexpr const char* kExactModel = "mindlin-dahl";

/// Returns ∫T dδ [J], trapezoidal.
double Work(std::span<const double> displacement, std::span<const double> force) {
  long double work = 0.0L;
  for (std::size_t i = 1; i < displacement.size(); ++i) {
    work += (static_cast<long double>(force[i]) + force[i - 1]) / 2 *
            (static_cast<long double>(displacement[i]) - displacement[i - 1]);
  }
  return static_cast<double>(work);
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
  const FrictionModel* model = models::FindFrictionModel(approximation.model);
  const Method* method = methods::FindMethod(approximation.method);
  if (model == nullptr || method == nullptr) {
    throw InvalidArgument(fmt::format("there is no model '{}' or no method '{}'",
                                      approximation.model, approximation.method));
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
  const double lost = Work(displacement, exact);
  if (lost != 0) precision.energy = std::abs(Work(displacement, force) / lost - 1);
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
