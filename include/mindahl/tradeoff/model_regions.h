#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::tradeoff {

/// Amplitudes over the gross-slip displacement at which a model errs by no more than a tolerance.
struct LambdaRange {
  double from = 0.0;  ///< the least studied where it goes on below
  double to = 0.0;    ///< the greatest studied where it goes on above
};

/// Holds the range in which one model is good enough in one cycle of a steady drive.
struct ModelRegion {
  std::string model;
  std::size_t cycle = 1;                       ///< from 1, the virgin loading being the first
  Criterion criterion = Criterion::kMaxForce;  ///< or kEnergy, that lost in the cycle
  double tolerance = 0.0;                      ///< relative to T* or to the energy [–]
  std::vector<LambdaRange> ranges;             ///< ascending, none where it is nowhere
};

struct ModelRegionOptions {
  std::vector<double> tolerances = {0.001, 0.01, 0.05};
  std::size_t cycles = 5;  ///< >= 1
  double least_lambda = 1e-4;
  double greatest_lambda = 1e6;
};

/// Regions of every model of ModelLadder, in exact closed form, against the Masing law, at the same
/// σ and Tc, and the same α where the model prescribes none. Errors do not depend on the sampling:
/// samples lie evenly, 150 of them, within twice the gross-slip displacement of each reversal,
/// where branches are curved. Bounds of a range are found to 0.2 %; a range narrower than a twelfth
/// of a decade may be missed.
/// @param law  α < 1, since λ counts gross-slip displacements
/// @throws InvalidArgument for an invalid law, α >= 1 or options out of range
/// Takes about a second and 30 MB with the options' defaults.
std::vector<ModelRegion> FindModelRegions(const models::BranchLaw& law,
                                          const ModelRegionOptions& options = {});

}  // namespace mindahl::tradeoff
