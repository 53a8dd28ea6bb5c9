#pragma once

#include <cstddef>
#include <deque>
#include <string>

#include "mindahl/campaign/cycle_fit.h"

namespace mindahl::campaign {

/// Counts the fits in a sum of energies by how the energy of each was obtained.
struct EnergyCounts {
  std::size_t measured = 0;  ///< fits with an energy of their own, glitches interpolated
  std::size_t replaced = 0;  ///< fits given the energy per sample of the measured ones before
  std::size_t left_out = 0;  ///< fits with no energy known, or none dissipated
};

/// Returns ", counting 2 that do not close by those before them and 1 by nothing"; nothing where
/// all were measured.
std::string InWords(const EnergyCounts& counts);

/// Energy [J] dissipated over a test, from fits in their order.
///
/// A cycle that does not end where it began is no loop, and what is between its ends is no energy
/// dissipated: a spike of the displacement, which turns it, makes two of one cycle with ten times
/// its energy. Such count for W = n·median(Wₖ/nₖ) of the last nine measured ones, n the steps
/// between samples, so that the parts of a cycle count for it together; before any was measured
/// they are left out. A glitch of the force is interpolated linearly, and costs a few per cent.
class DissipatedEnergy {
 public:
  /// @param cycles  that a fit stands for, >= 1
  explicit DissipatedEnergy(std::size_t cycles) : cycles_(static_cast<double>(cycles)) {}

  void Add(const CycleFit& fit);

  [[nodiscard]] double total() const { return total_; }
  [[nodiscard]] const EnergyCounts& counts() const { return counts_; }

 private:
  double cycles_;
  double total_ = 0.0;
  EnergyCounts counts_;
  std::deque<double> of_a_step_;  // [J], of the last that were measured
};

}  // namespace mindahl::campaign
