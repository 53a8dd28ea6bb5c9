#include "identification/inference/rivals.h"

#include <array>
#include <cmath>
#include <utility>

#include "identification/inference/noise.h"
#include "identification/solve/search.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"

namespace mindahl::identification {

using contact::kMindlinShapeExponent;

Rival RivalAt(const Parameters& parameters, std::span<const double> theta) {
  return {parameters.LawAt(theta), parameters.LoadExponentAt(theta)};
}

ParameterEstimates IncludeRival(const Rival& rival, const Thresholds& thresholds,
                                ParameterEstimates parameters) {
  if (rival.law.tangential_stiffness >= thresholds.rigid_beside_rig * rival.rig.stiffness) {
    return parameters;
  }
  for (ParameterEstimate& estimate : parameters) {
    const auto include = [&](double lower, double upper) {
      Include(estimate, {.lower = lower, .upper = upper});
    };
    if (estimate.name == "alpha") include(rival.law.shape_exponent, rival.law.shape_exponent);
    if (estimate.name == "load_exponent") include(rival.load_exponent, rival.load_exponent);
    if (estimate.name != "sigma" && estimate.name != "slip_force") continue;
    const double value =
        estimate.name == "sigma" ? rival.law.tangential_stiffness : rival.law.slip_force;
    if (estimate.lower95 && estimate.upper95) {
      IncludeRatios(estimate, std::array{value / estimate.value});
    } else {
      include(value, value);
    }
  }
  return parameters;
}

std::optional<Rival> TryRig(const Estimates& fitted, const ParameterEstimate& shape,
                            const FitOptions& options, Solver& solver) {
  const Problem& problem = fitted.problem();
  const Solution& best = fitted.solution();
  const Noise& noise = fitted.noise();
  // The law of a load that varies has none, nor has that of an imposed force; a prior says what α
  // is.
  if (problem.data->load_varies || problem.data->is_forced() || problem.parameters.has_rig() ||
      problem.parameters[kShape].has_prior() || shape.status == ParameterStatus::kFixed ||
      !shape.upper95 || !(*shape.upper95 < kMindlinShapeExponent) ||
      !(kMindlinShapeExponent - shape.value > options.thresholds.shape_effect)) {
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
  const auto samples = static_cast<double>(noise.samples);
  const double loss = Evidence(noise.samples, samples * fitted.WhiteShare(kShape))
                          .FStatistic(solution.sum_of_squares, best.sum_of_squares, noise.variance);
  if (!solution.converged || !(loss < options.thresholds.indistinguishable)) return std::nullopt;
  Rival rival = RivalAt(sprung.problem.parameters, solution.theta);
  rival.rig = sprung.problem.parameters.RigAt(solution.theta);
  return rival;
}

}  // namespace mindahl::identification
