#include "mindahl/tradeoff/model_regions.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mindahl/core/error.h"

namespace mindahl::tradeoff {

using models::BranchLaw;

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
