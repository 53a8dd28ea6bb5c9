#pragma once

#include <ceres/loss_function.h>

#include <memory>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "identification/solve/starts.h"
#include "mindahl/identification/fit_options.h"

namespace mindahl::identification {

/// A problem, its best solution, and from where that was found.
struct Candidate {
  Candidate(const ScaledRecords& data, const FitOptions& options,
            const std::vector<models::InitialState>& states)
      : problem{&data, options.model, states, Parameters(data, options, states)} {}

  Problem problem;
  std::vector<StartingPoint> starts = {};
  Solution solution = {};
};

SolverOptions SolverOptionsOf(const FitOptions& options);

/// Finds the candidate's starting points on the thinned records, unless the options give one.
/// @param rival  of another initial state, as FindStarts() takes it
/// @returns the least cost there; infinity where none has the sign of the force
double FindStartsOf(Candidate& candidate, ThinnedRecords& thinned, const FitOptions& options,
                    double rival, Solver& solver);

/// Adds the solutions of the models with one term less as starting points, so that a model never
/// fits worse than one that it contains. Those are solved from starting points of their own and,
/// for at most three terms, from the solutions of the models that they contain in turn.
void AddStartsOfSmallerModels(Candidate& candidate, ThinnedRecords& thinned,
                              const FitOptions& options, Solver& solver);

/// Solves from each starting point and keeps the best solution.
void Descend(Candidate& candidate, const FitOptions& options, Solver& solver);

/// Solves once more from next to the best solution where there may be lower minima, and keeps the
/// best: a law with a sharp knee has a minimum between any two samples, one with a rig another
/// where the rig takes another part of the compliance, and a noisy virgin loop one that had been
/// loaded before. Where a start is given it is the only one.
void SearchBesideMinimum(Candidate& candidate, const FitOptions& options, Solver& solver);

/// Returns the loss ρ(z²) of a standardised residual z, which is 95 % efficient for normal noise
/// (Huber 1981; Holland & Welsch 1977): null for none.
std::unique_ptr<ceres::LossFunction> LossOf(Loss loss);

/// Minimises ½ Σ ρ((w·r/scale)²) of the samples by ceres::Solve, one residual block with a
/// ceres::LossFunction a sample and one without a loss a prior, over all free parameters within
/// their bounds.
/// @param loss      not Loss::kNone
/// @param scale     of the weighted residuals [units of the data], > 0
/// @param solution  θ is where the search starts; written but for sum of squares and residual
void SolveRobustly(const Problem& problem, Loss loss, double scale, const SolverOptions& options,
                   Solution& solution);

}  // namespace mindahl::identification
