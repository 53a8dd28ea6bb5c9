#include "mindahl/models/response.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "models/response_gradient.h"
#include "models/scaled_branches.h"
#include "models/series_spring.h"

namespace mindahl::models {

void ThrowBeyondReach(double displacement, double largest, double elastic_limit) {
  ThrowInvalid("displacement [m]", displacement,
               fmt::format("must be <= {:.3g} times the elastic limit of the steepest branch, "
                           "{:.3g} m, for shape exponents > 1",
                           largest, elastic_limit));
}

namespace {

template <typename Real>
void RequireSizes(const LoadingPath& path, std::span<const Real> displacement,
                  std::span<Real> force) {
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  RequireSameSize("displacement", displacement.size(), "loading path",
                  path.runs.empty() ? 0 : path.runs.back().end);
}

/// Validates a law also for the type of the samples, which Validate does not know.
template <typename Real>
void RequireRange(const BranchLaw& law) {
  Validate(law);
  if constexpr (std::is_same_v<Real, float>) {
    const auto require = [](std::string_view quantity, double value) {
      if (!std::isnormal(Narrow<float>(value)) || value > std::numeric_limits<float>::max()) {
        ThrowInvalid(quantity, value, "must be a normal float, about 2e-38 to 3e38");
      }
    };
    require("slip force [N]", law.slip_force);
    require("tangential stiffness over slip force [1/m]",
            law.tangential_stiffness / law.slip_force);
    if (law.shape_exponent > backbone::kLargestShapeExponent<float>) {
      ThrowInvalid("shape exponent [-]", law.shape_exponent, "must be <= 1e10 in single precision");
    }
  }
}

template <typename Real, typename Shape>
void EvaluateRuns(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                  const ScaledBranches& branches, const Shape& shape,
                  std::span<const Real> displacement, std::span<Real> force) {
  for (const BranchRun& run : path.runs) {
    const std::size_t count = run.end - run.begin;
    const ScaledBranch<double>& branch = branches[static_cast<std::size_t>(run.branch)];
    EvaluateRun(Narrow<Real>(branch), ShapeOn(shape, branch), static_cast<Real>(law.slip_force),
                static_cast<Real>(ForceLimit(model, path.asymmetry)),
                displacement.subspan(run.begin, count), force.subspan(run.begin, count));
  }
}

template <typename Real>
void Evaluate(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
              std::span<const Real> displacement, std::span<Real> force) {
  RequireRange<Real>(law);
  RequireSizes(path, displacement, force);
  const ScaledBranches branches = backbone::WithShape(law.shape_exponent, [&](const auto& shape) {
    return ScaleBranches(BranchScaling(model, law), path, shape);
  });
  RequireReach(law, branches, displacement);
  backbone::WithShape(Narrow<Real>(law.shape_exponent), [&](const auto& shape) {
    EvaluateRuns(model, law, path, branches, shape, displacement, force);
  });
}

void EvaluateInSeries(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                      std::span<const double> displacement, std::span<double> force,
                      const SeriesSpring& rig) {
  RequireRange<double>(law);
  RequireSizes(path, displacement, force);
  const double travel = models::SpringTravel(model, law, rig);
  backbone::WithShape(law.shape_exponent, [&](const auto& contact) {
    const SprungShape shape{contact, travel};
    const ScaledBranches branches = ScaleBranches(BranchScaling(model, law, travel), path, shape);
    RequireReach(law, branches, displacement);
    EvaluateRuns(model, law, path, branches, shape, displacement, force);
  });
}

template <typename Shape>
void EvaluateWithGradient(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                          const BranchScaling& scaling, const Shape& shape,
                          std::span<const double> displacement, std::span<double> force,
                          std::span<double> gradient) {
  const ScaledBranches branches = ScaleBranches(scaling, path, shape);
  RequireReach(law, branches, displacement);
  const Differentiation differentiation(scaling, law, shape);
  const auto branch_gradients = differentiation.Differentiate(path, branches);
  const double limit = ForceLimit(model, path.asymmetry);
  for (const BranchRun& run : path.runs) {
    const auto branch = static_cast<std::size_t>(run.branch);
    const auto& shape_on_branch = ShapeOn(shape, branches[branch]);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      double t = 0.0;
      const auto g = differentiation.DifferentiateSample(
          shape_on_branch, branches[branch], branch_gradients[branch], displacement[i], t);
      force[i] = law.slip_force * std::clamp(t, -limit, limit);
      double* row = &gradient[i * kGradientColumns];
      row[kPerLogStiffness] = law.slip_force * g[kRate];
      row[kPerShapeExponent] = law.slip_force * g[kShape];
      row[kPerLogSlipForce] = law.slip_force * (t - g[kRate]);
      row[kPerUnloadedDisplacement] = law.slip_force * g[kUnloaded];
      row[kPerLogSeriesStiffness] = 0.0;
      if constexpr (differentiation.kSprung) {  // c = Tc/k_r
        row[kPerLogSlipForce] += law.slip_force * g[kSpring];
        row[kPerLogSeriesStiffness] = -law.slip_force * g[kSpring];
      }
    }
  }
}

}  // namespace

void Validate(const SeriesSpring& rig) {
  if (!(rig.stiffness > 0)) {
    ThrowInvalid("series stiffness [N/m]", rig.stiffness, "must be > 0, infinite for a rigid rig");
  }
}

double GrossSlipDisplacement(const BranchLaw& law, const SeriesSpring& rig) {
  Validate(law);
  Validate(rig);
  return GrossSlipDisplacement(law) + law.slip_force / rig.stiffness;
}

void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const double> displacement, std::span<double> force,
                   const SeriesSpring& rig) {
  if (models::IsRigid(rig)) {
    Evaluate(model, law, path, displacement, force);
  } else {
    EvaluateInSeries(model, law, path, displacement, force, rig);
  }
}

void EvaluateForce(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                   std::span<const float> displacement, std::span<float> force) {
  Evaluate(model, law, path, displacement, force);
}

void EvaluateForceAndGradient(const FrictionModel& model, const BranchLaw& law,
                              const LoadingPath& path, std::span<const double> displacement,
                              std::span<double> force, std::span<double> gradient,
                              const SeriesSpring& rig) {
  RequireRange<double>(law);
  RequireSizes(path, displacement, force);
  RequireSameSize("gradient", gradient.size(), "displacement times gradient columns",
                  displacement.size() * kGradientColumns);
  if (models::IsRigid(rig)) {
    EvaluateWithGradient(model, law, path, BranchScaling(model, law),
                         DirectShape{law.shape_exponent}, displacement, force, gradient);
    return;
  }
  const double travel = models::SpringTravel(model, law, rig);
  EvaluateWithGradient(model, law, path, BranchScaling(model, law, travel),
                       SprungShape{backbone::GeneralShape<double>{law.shape_exponent}, travel},
                       displacement, force, gradient);
}

}  // namespace mindahl::models
