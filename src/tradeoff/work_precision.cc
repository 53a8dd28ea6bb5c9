#include "mindahl/tradeoff/work_precision.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mindahl/core/error.h"

namespace mindahl::tradeoff {

using methods::Drive;
using models::BranchLaw;

namespace {

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

Precision Compare(std::span<const double> exact, std::span<const double> displacement,
                  std::span<const double> force) {
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  RequireSameSize("exact force", exact.size(), "force", force.size());
  if (force.empty()) throw InvalidArgument("the drive is empty: must have samples");
  double peak = 0.0;
  for (const double at : exact) peak = std::max(peak, std::abs(at));
  const double scale = peak > 0 ? peak : 1.0;
  Precision precision;
  long double squares = 0.0L;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double error = (force[i] - exact[i]) / scale;
    // A force that is not a number is infinitely wrong; std::max would pass it over.
    precision.max_force =
        std::max(precision.max_force,
                 std::isnan(error) ? std::numeric_limits<double>::infinity() : std::abs(error));
    squares += static_cast<long double>(error) * error;
  }
  precision.rms_force =
      static_cast<double>(std::sqrt(squares / static_cast<long double>(force.size())));
  const double lost = Work(displacement, exact);
  if (lost != 0) precision.energy = std::abs(Work(displacement, force) / lost - 1);
  return precision;
}

std::vector<WorkPrecision> MeasureWorkPrecision(const BranchLaw& law, const Drive& drive) {
  std::vector<double> exact(drive.displacement.size());
  Prepare({ExactModel(law), "exact"}, law)(drive, exact);
  std::vector<WorkPrecision> points;
  std::vector<double> force(exact.size());
  for (const Approximation& approximation : AllApproximations(law)) {
    Prepare(approximation, law)(drive, force);
    points.push_back({.approximation = approximation,
                      .precision = Compare(exact, drive.displacement, force),
                      .cost = CostOf(approximation, law, drive)});
  }
  const std::vector<bool> front = ParetoFront(points);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].is_on_front = front[i];
  return points;
}

std::vector<bool> ParetoFront(std::span<const WorkPrecision> points) {
  std::vector<bool> on_front(points.size(), true);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = points[i].precision.max_force;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double other = points[j].precision.max_force;
      const bool no_worse = i != j && other <= error && points[j].cost <= points[i].cost;
      const bool better = other < error || points[j].cost < points[i].cost || j < i;
      if (no_worse && better) on_front[i] = false;
    }
  }
  return on_front;
}

std::size_t CheapestWithin(double tolerance, bool energy_counts,
                           std::span<const WorkPrecision> points) {
  if (!(tolerance > 0 && tolerance <= 1)) {
    ThrowInvalid("tolerance [-]", tolerance, "must be in (0, 1]");
  }
  constexpr double kSameCost = 1.1;
  const auto is_within = [&](const WorkPrecision& point) {
    return point.precision.max_force <= tolerance &&
           !(energy_counts && point.precision.energy.value_or(0) > tolerance);
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
