#pragma once

#include <cstddef>

#include "core/draws.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::reliability {

/// A contact, how it is driven and how it is measured, before anything goes wrong.
struct Truth {
  models::BranchLaw law;
  double reach = 2.0;  ///< amplitude over the displacement at which 99 % of Tc is mobilised
  std::size_t cycles = 3;
  std::size_t samples_per_cycle = 200;
  bool virgin = true;  ///< else the record begins in a steady loop, anywhere on it
  double frequency = 1.0;
  double noise = 0.005;              ///< of the force, white, over Tc
  double force_offset = 0.0;         ///< [N]
  double displacement_offset = 0.0;  ///< [m]
  int force_sense = 1;               ///< −1: the load cell is on the other body
};

/// α among 0, 1/3, the rest of 0 … 1 and 1 … 1.5; σ over seven decades, Tc over ten; reach 0.8 … 4;
/// one to six cycles of 100 to 400 samples; virgin or not, off centre, force of either sense.
Truth DrawTruth(Draws& draws);

/// Displacement [m] at which a virgin contact carries 99 % of Tc: as good as slip, for every α.
double SlipDisplacement(const models::BranchLaw& law);

/// X [m]
double Amplitude(const Truth& truth);

}  // namespace mindahl::reliability
