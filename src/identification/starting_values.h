#pragma once

#include <vector>

#include "identification/parameter_layout.h"
#include "identification/scaled_records.h"
#include "mindahl/identification/fit.h"

namespace mindahl::identification {

struct StartingPoint {
  std::vector<double> theta;  // all parameters
  double sum_of_squares = 0.0;
  bool drawn = false;  // at random, not from the grid
};

/// Starting points from the data, best first.
///
/// In t(δ; σ/Tc, α) the response is Tc·t + F₀: on a grid over σX/Tc and α the slip force and the
/// force offset follow by linear regression, so that the grid has two dimensions and needs neither
/// slopes nor plateaus read off noisy data. A virgin contact is tried unloaded at the first sample,
/// at the centre of the record and at displacement zero. Points on the same α compete, or, where α
/// is held, of the same third of the grid; the best of each α go on, after a closer look round
/// each. Where options ask for more starts than that, the others are drawn at random over the same
/// range, seeded, and follow in the order of drawing; draws with the wrong sense of force are
/// dropped.
std::vector<StartingPoint> FindStartingPoints(const ScaledRecords& data,
                                              const ParameterLayout& layout,
                                              const FitOptions& options,
                                              models::InitialState state);

}  // namespace mindahl::identification
