#include "identification/inference/rivals.h"

#include <array>
#include <cmath>
#include <utility>

#include "identification/solve/search.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"

namespace mindahl::identification {

using contact::kMindlinShapeExponent;

void IncludeLaw(const models::BranchLaw& law, const models::SeriesSpring& rig,
                const Thresholds& thresholds, ParameterEstimates& parameters) {
  if (law.tangential_stiffness >= thresholds.rigid_beside_rig * rig.stiffness) return;
  Include(parameters[kShape], {.lower = law.shape_exponent, .upper = law.shape_exponent});
  for (const auto& [p, value] :
       {std::pair(kStiffness, law.tangential_stiffness), std::pair(kSlipForce, law.slip_force)}) {
    ParameterEstimate& estimate = parameters[p];
    if (estimate.lower95 && estimate.upper95) {
      IncludeRatios(estimate, std::array{value / estimate.value});
    } else {
      Include(estimate, {.lower = value, .upper = value});
    }
  }
}

std::optional<Finding> IncludeCompliantRig(const Estimates& fitted, const FitOptions& options,
                                           Solver& solver, ParameterEstimates& parameters) {
  const Problem& problem = fitted.problem();
  const Solution& best = fitted.solution();
  const Thresholds& thresholds = options.thresholds;
  const ParameterEstimate& shape = parameters[kShape];
  // The law of a load that varies has none, nor has that of an imposed force; a prior says what α
  // is.
  if (problem.data->load_varies || problem.data->is_forced() || problem.parameters.has_rig() ||
      problem.parameters[kShape].has_prior() || shape.status == ParameterStatus::kFixed ||
      !shape.upper95 || !(*shape.upper95 < kMindlinShapeExponent) ||
      !(kMindlinShapeExponent - shape.value > thresholds.shape_effect)) {
    return std::nullopt;
  }
  constexpr double kStiffer = 0.1;  // of the compliance is the contact's
  FitOptions with_rig = options;
  with_rig.terms.emplace_back("rig_stiffness");
  with_rig.fixed["alpha"] = kMindlinShapeExponent;
  with_rig.start.clear();
  Candidate sprung(*problem.data, with_rig, problem.states);
  // A rig as stiff as the fitted contact, before one ten times stiffer, with the terms that it has.
  std::vector<double> beside = best.theta;
  beside[kRig] = best.theta[kStiffness] + std::log(1 / (1 - kStiffer));
  beside[kStiffness] -= std::log(kStiffer);
  beside[kShape] = kMindlinShapeExponent;
  sprung.starts.push_back({.theta = std::move(beside)});
  Descend(sprung, with_rig, solver);
  const Solution& solution = sprung.solution;
  // Both have as many parameters: ΔAICc is 2 ln Λ.
  const double loss = fitted.FStatistic(kShape, solution.sum_of_squares);
  if (!solution.converged || !(loss < thresholds.indistinguishable)) return std::nullopt;
  const models::SeriesSpring rig = sprung.problem.parameters.RigAt(solution.theta);
  IncludeLaw(sprung.problem.parameters.LawAt(solution.theta), rig, thresholds, parameters);
  for (ParameterEstimate& estimate : parameters) {
    const double exponent = sprung.problem.parameters.LoadExponentAt(solution.theta);
    if (estimate.name == "load_exponent") Include(estimate, {exponent, exponent});
  }
  return Finding{.code = "shape_or_rig", .numbers = {{"rig_stiffness", rig.stiffness}}};
}

}  // namespace mindahl::identification
