#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"

namespace mindahl::identification {

struct StartingPoint {
  std::vector<double> theta;  // all parameters
  double cost = 0.0;          // on the thinned record
  double look = 0.0;          // of the best look there
};

/// True if α is held at 0: the likelihood has a kink wherever a sample begins to slip, and minima
/// next to each other; all samples are used, and four starts followed.
bool HasKinks(const Parameters& parameters);

/// The options' own start, where it leaves nothing to be looked for.
std::optional<StartingPoint> GivenStart(const Parameters& parameters, const FitOptions& options);

/// Starting points from the data, best first.
///
/// On a thinned record the cost is looked at over the plane of σX/Tc and α, Tc and all that is
/// linear eliminated, so that neither slopes nor plateaus are read off noisy data. A virgin contact
/// is tried unloaded at the first sample, at the centre of the record and at displacement zero; a
/// rig of unknown stiffness at some ratios to the contact's. The best of each α, or where α is held
/// of each third of the plane, goes on to the minimum of the thinned record.
/// @param thin      the problem on its thinned record
/// @param rival     look of another initial state; of looks ten times as dear the best alone
///                  is followed. Infinite where there is none
/// @returns empty where no point has the sign of the force
std::vector<StartingPoint> FindStarts(const Problem& thin, const FitOptions& options, double rival,
                                      Solver& solver);

}  // namespace mindahl::identification
