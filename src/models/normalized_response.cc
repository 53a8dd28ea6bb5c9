#include "mindahl/models/normalized_response.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "models/response_gradient.h"
#include "models/scaled_branches.h"

namespace mindahl::models {
namespace {

using RigidDifferentiation = Differentiation<DirectShape>;
using SprungDifferentiation = Differentiation<SprungShape<backbone::GeneralShape<double>>>;

/// Tc = 1: forces and stiffnesses are those over it.
BranchLaw LawOf(const NormalizedLaw& law) {
  return {
      .tangential_stiffness = law.rate, .shape_exponent = law.shape_exponent, .slip_force = 1.0};
}

void RequireSizes(const LoadingPath& path, std::span<const double> displacement,
                  std::span<const double> t) {
  RequireSameSize("displacement", displacement.size(), "response", t.size());
  RequireSameSize("displacement", displacement.size(), "loading path",
                  path.runs.empty() ? 0 : path.runs.back().end);
}

}  // namespace

struct NormalizedResponse::Buffers {
  ScaledBranches branches;
  std::vector<RigidDifferentiation::BranchGradient> rigid;
  std::vector<SprungDifferentiation::BranchGradient> sprung;

  auto& GradientsOf(const RigidDifferentiation& /*differentiation*/) { return rigid; }
  auto& GradientsOf(const SprungDifferentiation& /*differentiation*/) { return sprung; }
};

NormalizedResponse::NormalizedResponse() : buffers_(std::make_unique<Buffers>()) {}
NormalizedResponse::NormalizedResponse(NormalizedResponse&&) noexcept = default;
NormalizedResponse& NormalizedResponse::operator=(NormalizedResponse&&) noexcept = default;
NormalizedResponse::~NormalizedResponse() = default;

void NormalizedResponse::Evaluate(const FrictionModel& model, const NormalizedLaw& law,
                                  const LoadingPath& path, std::span<const double> displacement,
                                  std::span<double> t) {
  const BranchLaw branch_law = LawOf(law);
  Validate(branch_law);
  RequireSizes(path, displacement, t);
  ScaledBranches& branches = buffers_->branches;
  const BranchScaling scaling(model, branch_law, law.spring_travel);
  const auto evaluate = [&](const auto& shape) {
    ScaleBranches(scaling, path, shape, branches);
    RequireReach(branch_law, branches, displacement);
    for (const BranchRun& run : path.runs) {
      const std::size_t count = run.end - run.begin;
      const ScaledBranch<double>& branch = branches[static_cast<std::size_t>(run.branch)];
      EvaluateRun(branch, ShapeOn(shape, branch), 1.0, ForceLimit(model),
                  displacement.subspan(run.begin, count), t.subspan(run.begin, count));
    }
  };
  backbone::WithShape(law.shape_exponent, [&](const auto& contact) {
    if (law.spring_travel == 0) {
      evaluate(contact);
    } else {
      evaluate(SprungShape{contact, law.spring_travel});
    }
  });
}

void NormalizedResponse::Differentiate(const FrictionModel& model, const NormalizedLaw& law,
                                       const LoadingPath& path,
                                       std::span<const double> displacement, std::span<double> t,
                                       const NormalizedGradient& gradient) {
  const BranchLaw branch_law = LawOf(law);
  Validate(branch_law);
  RequireSizes(path, displacement, t);
  ScaledBranches& branches = buffers_->branches;
  const BranchScaling scaling(model, branch_law, law.spring_travel);
  const double limit = ForceLimit(model);
  const auto differentiate = [&](const auto& shape) {
    ScaleBranches(scaling, path, shape, branches);
    RequireReach(branch_law, branches, displacement);
    const Differentiation differentiation(scaling, branch_law, shape);
    auto& gradients = buffers_->GradientsOf(differentiation);
    differentiation.Differentiate(path, branches, gradients);
    for (const BranchRun& run : path.runs) {
      const auto b = static_cast<std::size_t>(run.branch);
      const auto& shape_on_branch = ShapeOn(shape, branches[b]);
      for (std::size_t i = run.begin; i < run.end; ++i) {
        double force = 0.0;
        const auto g = differentiation.DifferentiateSample(shape_on_branch, branches[b],
                                                           gradients[b], displacement[i], force);
        t[i] = std::clamp(force, -limit, limit);
        if (!gradient.log_rate.empty()) gradient.log_rate[i] = g[kRate];
        if (!gradient.shape_exponent.empty()) gradient.shape_exponent[i] = g[kShape];
        if (!gradient.unloaded_displacement.empty()) {
          gradient.unloaded_displacement[i] = g[kUnloaded];
        }
        if (gradient.log_spring_travel.empty()) continue;
        gradient.log_spring_travel[i] = 0.0;
        if constexpr (differentiation.kSprung) gradient.log_spring_travel[i] = g[kSpring];
      }
    }
  };
  if (law.spring_travel == 0) {
    differentiate(DirectShape{law.shape_exponent});
  } else {
    differentiate(
        SprungShape{backbone::GeneralShape<double>{law.shape_exponent}, law.spring_travel});
  }
}

void NormalizedResponse::DifferentiateByOrigins(const FrictionModel& model,
                                                const NormalizedLaw& law, const LoadingPath& path,
                                                std::span<const double> displacement,
                                                OriginSensitivity& sensitivity) {
  const BranchLaw branch_law = LawOf(law);
  Validate(branch_law);
  ScaledBranches& branches = buffers_->branches;
  const BranchScaling scaling(model, branch_law, law.spring_travel);
  const std::size_t count = path.branches.size();
  sensitivity.slope.assign(count, 0.0);
  sensitivity.gain.assign(count, 0.0);
  sensitivity.per_amplitude.assign(count, 0.0);
  sensitivity.sample_slope.resize(displacement.size());
  sensitivity.sample_gain.resize(displacement.size());
  const auto differentiate = [&](const auto& shape) {
    ScaleBranches(scaling, path, shape, branches);
    const Differentiation differentiation(scaling, branch_law, shape);
    auto& by_origin = buffers_->GradientsOf(differentiation);
    by_origin.clear();
    const auto at = [&](std::size_t b, double x, double& slope, double& gain) {
      double force = 0.0;
      const auto g = differentiation.DifferentiateSample(ShapeOn(shape, branches[b]), branches[b],
                                                         by_origin[b], x, force);
      slope = -g[kUnloaded];
      gain = g[kRate];
    };
    for (std::size_t b = 0; b < count; ++b) {
      const Branch& branch = path.branches[b];
      if (branch.start == BranchStart::kReversal) {
        at(static_cast<std::size_t>(branch.parent), branch.origin, sensitivity.slope[b],
           sensitivity.gain[b]);
      } else if (branch.start == BranchStart::kSteadyExtreme) {
        sensitivity.per_amplitude[b] = -branch.direction *
                                       scaling.DifferentiatePeak(branch).peak.per_log_stiffness /
                                       branch.amplitude;
      }
      by_origin.push_back(differentiation.DifferentiateByOriginForce(branch, branches[b].force));
    }
    for (const BranchRun& run : path.runs) {
      for (std::size_t i = run.begin; i < run.end; ++i) {
        at(static_cast<std::size_t>(run.branch), displacement[i], sensitivity.sample_slope[i],
           sensitivity.sample_gain[i]);
      }
    }
  };
  if (law.spring_travel == 0) {
    differentiate(DirectShape{law.shape_exponent});
  } else {
    differentiate(
        SprungShape{backbone::GeneralShape<double>{law.shape_exponent}, law.spring_travel});
  }
}

}  // namespace mindahl::models
