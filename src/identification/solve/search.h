#pragma once

#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"

namespace mindahl::identification {

/// A problem, its best solution, and from where that was found.
struct Candidate {
  Problem problem;
  std::vector<std::vector<double>> starts = {};  // θ of all parameters
  Solution solution = {};
};

/// Finds the candidate's starting points, best first, from the data or as the options give them.
/// On a thinned record the cost is looked at over the plane of σX/Tc and α, Tc and all that is
/// linear eliminated (docs/theory.md §12). The best look goes on to the minimum of the thinned
/// record; with terms that of each α, or where α is held of each third of the plane.
/// @returns the least cost there; infinity where none has the sign of the force
double FindStartsOf(Candidate& candidate, const ScaledRecords& thinned, const FitOptions& options);

/// Adds the solutions of the models with one term less as starting points, so that a model never
/// fits worse than one that it contains. Those are solved from starting points of their own and,
/// for at most three terms, from the solutions of the models that they contain in turn.
void AddStartsOfSmallerModels(Candidate& candidate, const ScaledRecords& thinned,
                              const FitOptions& options);

/// Solves from each starting point and keeps the best solution.
void Descend(Candidate& candidate, const FitOptions& options);

/// Solves again from next to the best solution where there may be lower minima, as of a law with a
/// sharp knee, of a loop that hardly slips and beside a rig, and goes on from the best as long as
/// one is lower. Where a start is given it is the only one.
void SearchBesideMinimum(Candidate& candidate, const FitOptions& options);

}  // namespace mindahl::identification
