#include "identification/solve/search.h"

#include <algorithm>
#include <cmath>
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
  const auto& free = problem.parameters.free();
  if (std::ranges::none_of(free,
                           [&](std::size_t p) { return problem.parameters[p].term->has_start; })) {
    return;
  }
  Problem law = problem;
  for (const std::size_t p : free) {
    if (problem.parameters[p].term->presence != Presence::kOnDemand || p == kRig) continue;
    law.parameters.Fix(p, problem.parameters[p].theta);
  }
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

namespace {

/// Returns the value with which a term on demand has no effect: a rigid rig, or zero.
double NeutralTheta(const Parameters& parameters, std::size_t p) {
  return p == kRig ? parameters[p].upper : parameters[p].ToTheta(0.0);
}

}  // namespace

void AddStartsOfSmallerModels(Candidate& candidate, ThinnedRecords& thinned,
                              const FitOptions& options, SearchBuffers& buffers,
                              std::pmr::memory_resource* memory) {
  constexpr std::size_t kMostNested = std::tuple_size_v<decltype(SearchBuffers::smaller)>;
  if (!options.start.empty()) return;
  const Parameters& parameters = candidate.problem.parameters;
  std::pmr::vector<std::size_t> terms(memory);
  for (const std::size_t p : parameters.free()) {
    // What a word of the command line asks for; its further coefficients stay with it.
    const Term& term = *parameters[p].term;
    if (term.presence == Presence::kOnDemand && !term.option.empty()) terms.push_back(p);
  }
  if (terms.empty()) return;
  Solution& solution = buffers.smaller[std::min(terms.size(), kMostNested) - 1];
  for (const std::size_t p : terms) {
    const double neutral = NeutralTheta(parameters, p);
    if (neutral < parameters[p].lower || neutral > parameters[p].upper) continue;
    Candidate smaller(candidate, p, neutral, memory);
    smaller.solution = &solution;
    FindStartsOf(smaller, thinned, options, std::numeric_limits<double>::infinity(), buffers,
                 memory);
    if (terms.size() <= kMostNested) {
      AddStartsOfSmallerModels(smaller, thinned, options, buffers, memory);
    }
    Descend(smaller, options, buffers, nullptr);
    if (!std::isfinite(solution.sum_of_squares)) continue;
    candidate.starts.push_back({.theta = {solution.theta.begin(), solution.theta.end(), memory},
                                .cost = solution.sum_of_squares});
  }
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
