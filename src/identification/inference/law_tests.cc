#include "identification/inference/law_tests.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory_resource>
#include <span>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/dense.h"
#include "identification/inference/local.h"
#include "identification/inference/noise.h"
#include "identification/intervals.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

namespace {

/// Compares fits that differ in α.
Evidence EvidenceOfShape(const Noise& noise, const Estimates& estimates) {
  return {noise.samples, static_cast<double>(noise.samples) * estimates.WhiteShare(kShape)};
}

}  // namespace

std::optional<MindlinTest> TestMindlin(const FittedProblem& fitted, const FitOptions& options,
                                       SearchBuffers& buffers) {
  const auto& [problem, best, noise, estimates] = fitted;
  if (problem.parameters[kShape].fixed) return std::nullopt;
  const Problem held = problem.WithFixed(kShape, kMindlinExponent);
  Solution solution;
  buffers.solver.Bind(held, buffers.response);
  buffers.solver.Solve(best.theta, SolverOptionsOf(options), solution);
  MindlinTest test;
  const double statistic =
      EvidenceOfShape(noise, estimates)
          .FStatistic(solution.sum_of_squares, best.sum_of_squares, noise.variance);
  test.p_value = PValueOfF(statistic, noise.degrees_of_freedom(problem.parameters.free().size()));
  return test;
}

bool WantsRig(const Problem& problem, const Solution& best, const MindlinTest& test,
              const Thresholds& thresholds) {
  return test.p_value < thresholds.significance &&
         kMindlinExponent - best.theta[kShape] > thresholds.shape_effect &&
         !problem.parameters.has_rig();
}

std::optional<RigAlternative> TryRig(const FittedProblem& fitted, ThinnedRecords& thin,
                                     const MindlinTest& test, const FitOptions& options,
                                     SearchBuffers& buffers) {
  const Problem& problem = fitted.problem;
  const Solution& best = fitted.solution;
  // The law of a load that varies has none, nor has that of an imposed force.
  const bool is_wanted = WantsRig(problem, best, test, options.thresholds);
  if (!is_wanted || problem.data->load_varies || problem.data->is_forced()) return std::nullopt;
  FitOptions with_rig = options;
  with_rig.terms.emplace_back("rig_stiffness");
  with_rig.fixed["alpha"] = kMindlinExponent;
  with_rig.start.clear();
  Candidate sprung(*problem.data, with_rig, problem.state, std::pmr::get_default_resource());
  Solution solution;
  sprung.solution = &solution;
  FindStartsOf(sprung, thin, with_rig, std::numeric_limits<double>::infinity(), buffers,
               std::pmr::get_default_resource());
  Descend(sprung, with_rig, buffers);
  // Both have as many parameters: ΔAICc is 2 ln Λ.
  const double loss =
      EvidenceOfShape(fitted.noise, fitted.estimates)
          .FStatistic(solution.sum_of_squares, best.sum_of_squares, fitted.noise.variance);
  if (!solution.converged || !(loss < options.thresholds.indistinguishable)) return std::nullopt;
  return RigAlternative{
      .rig_stiffness = sprung.problem.parameters.RigAt(solution.theta).stiffness,
      .tangential_stiffness = sprung.problem.parameters.LawAt(solution.theta).tangential_stiffness};
}

ParameterEstimates IncludeRig(const RigAlternative& rig, const Thresholds& thresholds,
                              ParameterEstimates parameters) {
  if (rig.tangential_stiffness >= thresholds.rigid_beside_rig * rig.rig_stiffness) {
    return parameters;
  }
  Include(parameters[kShape], {.lower = kMindlinExponent, .upper = kMindlinExponent});
  ParameterEstimate& sigma = parameters[kStiffness];
  const double ratio = rig.tangential_stiffness / sigma.value;
  if (sigma.lower95 && sigma.upper95) {
    Include(sigma, {.lower = ratio * *sigma.lower95, .upper = ratio * *sigma.upper95});
  }
  return parameters;
}

}  // namespace mindahl::identification
