#pragma once

#include <cstddef>
#include <vector>

#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

/// A virgin contact of slip forces Tc(1 ± asymmetry) that is cycled between ±amplitude.
struct AsymmetricCycles {
  double asymmetry = 0.0;   ///< in (−1, 1), for positive displacement
  double amplitude = 0.0;   ///< [m] > 0, of contact and rig
  int first_direction = 1;  ///< ±1: of the first loading
  std::size_t cycles = 1;
};

/// Energy [J] lost in each cycle, the first from the first turning point on: elements that slip in
/// one direction only move in it, until they do not slip any more; from then on the energy is that
/// of the steady loop. Relative error below 1e-5: the force is integrated along 1000 steps a
/// stroke.
std::vector<double> EnergyOfCycles(const models::FrictionModel& model, const models::BranchLaw& law,
                                   const models::SeriesSpring& rig, const AsymmetricCycles& cycles);

}  // namespace mindahl::identification
