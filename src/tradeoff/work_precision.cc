#include "mindahl/tradeoff/work_precision.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/tradeoff/approximation.h"

namespace mindahl::tradeoff {

using methods::Drive;
using models::BranchLaw;

namespace {

/// The extrema that a Masing contact remembers, each with the force there.
class RememberedExtrema {
 public:
  explicit RememberedExtrema(const BranchLaw& law) : law_(law) {}

  /// Returns the force over Tc at `displacement`.
  long double MoveTo(double displacement) {
    Forget(displacement);
    const long double force = ForceAt(displacement);
    last_ = displacement;
    last_force_ = force;
    return force;
  }

  void Reverse() { extrema_.push_back({last_, last_force_}); }

 private:
  struct Extremum {
    double displacement;
    long double force;
  };

  /// A swing as long as the one that it answers closes the loop between them; the first extremum
  /// answers the unloaded contact, and is passed on either side.
  void Forget(double displacement) {
    while (!extrema_.empty()) {
      if (extrema_.size() == 1) {
        if (std::abs(displacement) < std::abs(extrema_[0].displacement)) return;
        extrema_.clear();
        return;
      }
      const double newest = extrema_.back().displacement;
      const double answered = extrema_[extrema_.size() - 2].displacement;
      if (std::abs(displacement - newest) < std::abs(answered - newest)) return;
      extrema_.resize(extrema_.size() - 2);
    }
  }

  [[nodiscard]] long double ForceAt(double displacement) const {
    if (extrema_.empty()) return Backbone(displacement, 1);
    return extrema_.back().force + 2 * Backbone(displacement - extrema_.back().displacement, 0.5L);
  }

  /// Returns φ of a fraction of x, with its sign.
  [[nodiscard]] long double Backbone(double x, long double share) const {
    const auto y =
        models::backbone::Normalize(law_.tangential_stiffness, std::abs(x), law_.slip_force);
    const auto at = models::backbone::Reduce({y.high * share, y.low * share},
                                             static_cast<long double>(law_.shape_exponent));
    const long double force =
        models::backbone::GeneralShape<long double>{law_.shape_exponent}.Force(at);
    return x < 0 ? -force : force;
  }

  const BranchLaw& law_;
  std::vector<Extremum> extrema_;
  double last_ = 0.0;
  long double last_force_ = 0.0L;
};

/// Returns ∫T dδ [J], trapezoidal.
double Work(std::span<const double> displacement, std::span<const double> force,
            std::size_t first) {
  long double work = 0.0L;
  for (std::size_t i = first + 1; i < displacement.size(); ++i) {
    work += (static_cast<long double>(force[i]) + force[i - 1]) / 2 *
            (static_cast<long double>(displacement[i]) - displacement[i - 1]);
  }
  return static_cast<double>(work);
}

/// Returns ns a sample; `run` once before, so that memory is warm.
template <typename Run>
double CostOfRun(std::size_t samples, Run&& run) {
  using Clock = std::chrono::steady_clock;
  constexpr double kBudget = 1e7;  // [ns]
  constexpr int kLeastRuns = 3;
  run();
  double least = std::numeric_limits<double>::infinity();
  double spent = 0.0;
  for (int runs = 0; runs < kLeastRuns || spent < kBudget; ++runs) {
    const auto begin = Clock::now();
    run();
    const double elapsed = std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
    least = std::min(least, elapsed);
    spent += elapsed;
  }
  return least / static_cast<double>(samples);
}

/// Makes the compiler assume that memory is read.
void Keep(std::span<const double> values) { asm volatile("" : : "g"(values.data()) : "memory"); }

}  // namespace

ReferenceResponse MakeReferenceResponse(const BranchLaw& law, const Drive& drive) {
  Validate(law);
  if (drive.displacement.empty()) throw InvalidArgument("the drive is empty: must have samples");
  for (const double displacement : drive.displacement) {
    RequireFinite("displacement [m] of the drive", displacement);
  }
  ReferenceResponse reference;
  RememberedExtrema remembered(law);
  double direction = 0.0;
  double last = 0.0;
  for (const double displacement : drive.displacement) {
    const double step = displacement - last;
    if (step != 0) {
      if (direction * step < 0) remembered.Reverse();
      direction = step;
    }
    last = displacement;
    const double force = static_cast<double>(law.slip_force * remembered.MoveTo(displacement));
    reference.force.push_back(force);
    reference.peak_force = std::max(reference.peak_force, std::abs(force));
  }
  return reference;
}

Precision Compare(const ReferenceResponse& reference, const Drive& drive,
                  std::span<const double> force, std::size_t first) {
  RequireSameSize("displacement", drive.displacement.size(), "force", force.size());
  RequireSameSize("reference", reference.force.size(), "force", force.size());
  if (first >= force.size()) {
    ThrowInvalid("first sample that counts [-]", static_cast<double>(first),
                 "must be a sample of the drive");
  }
  Precision precision;
  const double scale = reference.peak_force > 0 ? reference.peak_force : 1.0;
  long double squares = 0.0L;
  for (std::size_t i = first; i < force.size(); ++i) {
    const double error = (force[i] - reference.force[i]) / scale;
    // A force that is not a number is infinitely wrong; std::max would pass it over.
    precision.max_force =
        std::max(precision.max_force,
                 std::isnan(error) ? std::numeric_limits<double>::infinity() : std::abs(error));
    squares += static_cast<long double>(error) * error;
  }
  precision.rms_force =
      static_cast<double>(std::sqrt(squares / static_cast<long double>(force.size() - first)));
  const double exact = Work(drive.displacement, reference.force, first);
  if (exact != 0) {
    precision.energy = std::abs(Work(drive.displacement, force, first) / exact - 1);
  }
  return precision;
}

double ErrorBy(Criterion criterion, const Precision& precision) {
  switch (criterion) {
    case Criterion::kMaxForce:
      return precision.max_force;
    case Criterion::kRmsForce:
      return precision.rms_force;
    case Criterion::kEnergy:
      break;
  }
  return precision.energy.value_or(std::numeric_limits<double>::infinity());
}

CostFloor MeasureCostFloor(const Drive& drive) {
  const std::span<const double> displacement = drive.displacement;
  std::vector<double> force(displacement.size());
  CostFloor floor;
  floor.memory = CostOfRun(force.size(), [&] {
    for (std::size_t i = 0; i < force.size(); ++i) force[i] = 2 * displacement[i];
    Keep(force);
  });
  floor.arithmetic = CostOfRun(force.size(), [&] {
    for (std::size_t i = 0; i < force.size(); ++i) {
      force[i] = displacement[i] / (1 + std::sqrt(std::abs(displacement[i])));
    }
    Keep(force);
  });
  return floor;
}

double MeasureCost(const methods::Evaluator& evaluate, const Drive& drive,
                   std::span<double> force) {
  return CostOfRun(force.size(), [&] {
    evaluate(drive, force);
    Keep(force);
  });
}

CostFloor ModelledCostFloor() {
  const double sample = PriceOf(methods::Operation::kSample);
  return {sample, sample + PriceOf(methods::Operation::kRoot)};
}

WorkPrecision Assess(const Approximation& approximation, const BranchLaw& law, const Drive& drive,
                     const ReferenceResponse& reference, std::span<double> force,
                     std::size_t first) {
  Prepare(approximation, law)(drive, force);
  WorkPrecision point{.approximation = approximation,
                      .precision = Compare(reference, drive, force, first),
                      .operations = CountOperations(approximation, law, drive)};
  point.cost = ModelledCost(point.operations, force.size());
  return point;
}

std::vector<WorkPrecision> MeasureWorkPrecision(const BranchLaw& law, const Drive& drive,
                                                std::span<const Approximation> approximations) {
  const ReferenceResponse reference = MakeReferenceResponse(law, drive);
  std::vector<WorkPrecision> points;
  std::vector<double> force(drive.displacement.size());
  for (const Approximation& approximation : approximations) {
    WorkPrecision& point = points.emplace_back(Assess(approximation, law, drive, reference, force));
    point.measured_cost = MeasureCost(Prepare(approximation, law), drive, force);
  }
  return points;
}

std::vector<bool> ParetoFront(std::span<const WorkPrecision> points, Criterion criterion) {
  std::vector<bool> on_front(points.size(), true);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = ErrorBy(criterion, points[i].precision);
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j) continue;
      const double other = ErrorBy(criterion, points[j].precision);
      const bool no_worse = other <= error && points[j].cost <= points[i].cost;
      const bool better = other < error || points[j].cost < points[i].cost || j < i;
      if (no_worse && better) on_front[i] = false;
    }
  }
  return on_front;
}

namespace {

constexpr double kLambdasPerDecade = 12;
constexpr double kBoundTolerance = 1e-3;  // relative, of λ

void RequireRegionOptions(const BranchLaw& law, const ModelRegionOptions& options) {
  models::Validate(law);
  if (law.shape_exponent >= 1) {
    ThrowInvalid("shape exponent [-]", law.shape_exponent,
                 "must be < 1: lambda counts gross-slip displacements");
  }
  for (const double tolerance : options.tolerances) RequirePositive("tolerance [-]", tolerance);
  if (options.cycles == 0) ThrowInvalid("cycles [-]", 0.0, "must be >= 1");
  RequirePositive("least lambda [-]", options.least_lambda);
  RequireFinite("greatest lambda [-]", options.greatest_lambda);
  if (!(options.greatest_lambda > options.least_lambda)) {
    ThrowInvalid("greatest lambda [-]", options.greatest_lambda, "must exceed the least");
  }
}

/// Cycles between ±X. On every model a branch is curved within twice the gross-slip displacement of
/// its start only, where samples lie evenly, and straight beyond.
struct DenseCycles {
  std::vector<double> displacement;
  std::size_t loop = 0;    // samples of the loop from +X to +X, the first not counted
  std::size_t virgin = 0;  // samples up to +X
};

/// The cycles and the exact response to them, shared by the models.
struct Scene {
  DenseCycles dense;
  ReferenceResponse reference;
};

DenseCycles MakeDenseCycles(const BranchLaw& law, double amplitude, std::size_t cycles) {
  constexpr int kSteps = 150;
  DenseCycles dense;
  dense.displacement.push_back(0.0);
  const auto sweep = [&](double from, double to) {
    const double length = std::abs(to - from);
    const double curved = std::min(length, 2 * models::GrossSlipDisplacement(law));
    constexpr double kNearest = 1e-6;  // of the curved part: a force that jumps has jumped there
    std::vector<double> distances = {kNearest * curved};
    for (int i = 1; i <= kSteps; ++i)
      distances.push_back(curved * (static_cast<double>(i) / kSteps));
    // The corners of Jenkins' model, on the virgin curve and after a reversal.
    for (const double corner : {law.slip_force / law.tangential_stiffness,
                                2 * law.slip_force / law.tangential_stiffness}) {
      if (corner < curved) distances.push_back(corner);
    }
    std::ranges::sort(distances);
    if (curved < length) distances.push_back(length);
    for (const double distance : distances) {
      dense.displacement.push_back(distance == length ? to
                                                      : from + std::copysign(distance, to - from));
    }
  };
  sweep(0.0, amplitude);
  dense.virgin = dense.displacement.size();
  for (std::size_t cycle = 0; cycle < cycles; ++cycle) {
    sweep(amplitude, -amplitude);
    sweep(-amplitude, amplitude);
  }
  dense.loop = (dense.displacement.size() - dense.virgin) / cycles;
  return dense;
}

Scene MakeScene(const BranchLaw& law, double lambda, std::size_t cycles) {
  Scene scene;
  scene.dense = MakeDenseCycles(law, lambda * models::GrossSlipDisplacement(law), cycles);
  scene.reference = MakeReferenceResponse(law, {.displacement = scene.dense.displacement});
  return scene;
}

/// Returns the errors of each cycle: of the force, the first from the virgin loading on; of the
/// energy, that of the loop from +X to +X.
std::vector<Precision> ErrorsByCycle(const Scene& scene, const methods::Evaluator& evaluate,
                                     std::size_t cycles) {
  const DenseCycles& dense = scene.dense;
  std::vector<double> force(dense.displacement.size());
  evaluate({.displacement = dense.displacement}, force);
  const auto compare = [&](std::size_t begin, std::size_t end) {
    const auto part = [&](const std::vector<double>& values) {
      return std::span(values).subspan(begin, end - begin);
    };
    const auto exact = part(scene.reference.force);
    return Compare({{exact.begin(), exact.end()}, scene.reference.peak_force},
                   {.displacement = part(dense.displacement)}, part(force));
  };
  std::vector<Precision> errors;
  for (std::size_t cycle = 0; cycle < cycles; ++cycle) {
    const std::size_t end = dense.virgin + (cycle + 1) * dense.loop;
    Precision precision = compare(end - dense.loop - 1, end);
    if (cycle == 0) {
      precision.max_force = std::max(precision.max_force, compare(0, dense.virgin).max_force);
    }
    errors.push_back(precision);
  }
  return errors;
}

}  // namespace

std::vector<ModelRegion> FindModelRegions(const BranchLaw& law, const ModelRegionOptions& options) {
  RequireRegionOptions(law, options);
  std::vector<double> lambdas;
  const double decades = std::log10(options.greatest_lambda / options.least_lambda);
  const auto steps = static_cast<std::size_t>(std::ceil(decades * kLambdasPerDecade));
  for (std::size_t i = 0; i <= steps; ++i) {
    lambdas.push_back(options.least_lambda *
                      std::pow(10, decades * static_cast<double>(i) / static_cast<double>(steps)));
  }
  std::map<double, Scene> scenes;
  const auto scene_at = [&](double lambda) -> const Scene& {
    auto found = scenes.find(lambda);
    if (found == scenes.end()) {
      found = scenes.emplace(lambda, MakeScene(law, lambda, options.cycles)).first;
    }
    return found->second;
  };
  std::vector<ModelRegion> regions;
  for (const Approximation& approximation : ModelLadder(law)) {
    const methods::Evaluator evaluate = Prepare(approximation, law);
    std::map<double, std::vector<Precision>> known;
    const auto errors_at = [&](double lambda) -> const std::vector<Precision>& {
      auto found = known.find(lambda);
      if (found == known.end()) {
        found =
            known.emplace(lambda, ErrorsByCycle(scene_at(lambda), evaluate, options.cycles)).first;
      }
      return found->second;
    };
    for (std::size_t cycle = 0; cycle < options.cycles; ++cycle) {
      for (const Criterion criterion : {Criterion::kMaxForce, Criterion::kEnergy}) {
        for (const double tolerance : options.tolerances) {
          const auto is_within = [&](double lambda) {
            return ErrorBy(criterion, errors_at(lambda)[cycle]) <= tolerance;
          };
          /// λ between two of which one is within the tolerance and one is not.
          const auto bound = [&](double low, double high) {
            const bool low_is_within = is_within(low);
            while (high / low > 1 + kBoundTolerance) {
              const double middle = std::sqrt(low * high);
              (is_within(middle) == low_is_within ? low : high) = middle;
            }
            return low_is_within ? low : high;
          };
          ModelRegion region{approximation.model, cycle + 1, criterion, tolerance, {}};
          for (std::size_t i = 0; i < lambdas.size(); ++i) {
            if (!is_within(lambdas[i])) continue;
            if (i == 0 || !is_within(lambdas[i - 1])) {
              region.ranges.push_back(
                  {i == 0 ? lambdas[i] : bound(lambdas[i - 1], lambdas[i]), lambdas[i]});
            }
            region.ranges.back().to = i + 1 < lambdas.size() && !is_within(lambdas[i + 1])
                                          ? bound(lambdas[i], lambdas[i + 1])
                                          : lambdas[i];
          }
          regions.push_back(std::move(region));
        }
      }
    }
  }
  return regions;
}

}  // namespace mindahl::tradeoff
