#include "identification/solve/search.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace mindahl::identification {

SolverOptions SolverOptionsOf(const FitOptions& options) {
  // A full step from there is the last: it leaves far less than it gains.
  constexpr double kLastStep = 100.0;  // function tolerances
  return {.function_tolerance = options.function_tolerance,
          .parameter_tolerance = options.parameter_tolerance,
          .max_iterations = options.max_iterations,
          .last_step = kLastStep * options.function_tolerance};
}

namespace {

/// Adds the starts of the law alone, where terms that are not linear are searched with it: a model
/// that is larger must not end higher than the law.
void AddStartsOfLaw(const Problem& problem, const FitOptions& options, SearchBuffers& buffers,
                    std::pmr::memory_resource* memory, std::pmr::vector<StartingPoint>& starts) {
  Problem law = problem;
  bool is_larger = false;
  for (const std::size_t p : problem.parameters.free()) {
    const Term& term = *problem.parameters[p].term;
    if (term.presence != Presence::kOnDemand || p == kRig) continue;
    law.parameters.Fix(p, problem.parameters[p].theta);
    is_larger = is_larger || term.has_start;
  }
  if (!is_larger) return;
  for (StartingPoint& start :
       FindStarts(law, options, std::numeric_limits<double>::infinity(), buffers.solver,
                  buffers.response, buffers.scratch, memory)) {
    starts.push_back(std::move(start));
  }
}

}  // namespace

double FindStartsOf(Candidate& candidate, ThinnedRecords& thinned, const FitOptions& options,
                    double rival, SearchBuffers& buffers, std::pmr::memory_resource* memory) {
  if (auto given = GivenStart(candidate.problem.parameters, options, memory)) {
    candidate.starts.clear();
    candidate.starts.push_back(std::move(*given));
    return 0.0;
  }
  const ScaledRecords& thin = thinned.Get();
  // Where a window or a fold leaves little of the thinned record, all of it is looked at.
  constexpr std::size_t kEnough = 4;  // samples a parameter
  const bool is_enough = thin.counted >= kEnough * candidate.problem.parameters.free().size();
  // A thinned record has the history of the whole, and so tells a law; a column that wanders as it
  // likes explains a few samples a stroke whatever the law is.
  const bool has_covariate = std::ranges::any_of(
      candidate.problem.parameters.free(),
      [&](std::size_t p) { return candidate.problem.parameters[p].term->of_column; });
  const bool has_kinks = HasKinks(candidate.problem.parameters);
  const ScaledRecords& looked_at =
      is_enough && !has_covariate && !has_kinks ? thin : *candidate.problem.data;
  const Problem problem{&looked_at, candidate.problem.model, candidate.problem.state,
                        Parameters(candidate.problem.parameters, memory)};
  candidate.starts = FindStarts(problem, options, rival, buffers.solver, buffers.response,
                                buffers.scratch, memory);
  AddStartsOfLaw(problem, options, buffers, memory, candidate.starts);
  return candidate.starts.empty() ? std::numeric_limits<double>::infinity()
                                  : candidate.starts.front().cost;
}

void Descend(Candidate& candidate, const FitOptions& options, SearchBuffers& buffers,
             std::vector<Descent>* descents) {
  Solution& best = *candidate.solution;
  best.sum_of_squares = std::numeric_limits<double>::infinity();
  best.converged = false;
  best.report = {};
  best.report.message = "no starting point has the force's sense";
  if (candidate.starts.empty()) return;
  buffers.solver.Bind(candidate.problem, buffers.response);
  for (const StartingPoint& start : candidate.starts) {
    buffers.solver.Solve(start.theta, SolverOptionsOf(options), buffers.scratch);
    if (descents != nullptr) {
      Descent& descent = descents->emplace_back();
      descent.start.assign(start.theta.begin(), start.theta.end());
      std::vector<double> theta = descent.start;
      descent.start_cost = buffers.solver.CostAt(theta);
      descent.drawn = start.drawn;
      descent.solution = buffers.scratch;
    }
    if (buffers.scratch.sum_of_squares < best.sum_of_squares) std::swap(best, buffers.scratch);
  }
}

}  // namespace mindahl::identification
