#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string>

#include "mindahl/campaign/cycle_fit.h"

namespace mindahl::campaign {

/// Counts the fits in a sum of energies by how the energy of each was obtained.
struct EnergyCounts {
  std::size_t measured = 0;  ///< fits with an energy of their own, glitches interpolated
  std::size_t replaced = 0;  ///< fits given the energy per sample of the measured ones before
  std::size_t left_out = 0;  ///< fits with no energy known, or none dissipated
};

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

/// Compares the scatter of repeats of a test with their stated errors.
struct Repeats {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;  ///< between them
  /// Root of the mean square of the errors by which they should scatter; empty where they state
  /// none.
  std::optional<double> stated_error = {};
  /// Root of the mean square of the errors that they have in common, as of a model that misses the
  /// same in all: these neither scatter nor average out. Empty where they state none.
  std::optional<double> common_error = {};
  /// P(χ²(n − 1) ≥ Σ((x − x̄)/e)²), x̄ weighted: chance of such a scatter from the stated errors.
  std::optional<double> p_value = {};

  /// True if the stated errors make such a scatter with a chance below one in a hundred.
  [[nodiscard]] bool exceed_errors() const { return p_value && *p_value < 0.01; }
  /// Returns the standard error of the mean: of the larger of scatter and stated error over √n, and
  /// of what all have in common.
  [[nodiscard]] double mean_error() const;
  /// Returns "as the errors say, p 0.43", or "no error is stated".
  [[nodiscard]] std::string InWords() const;
};

/// @param values  of one quantity, one a test
/// @param errors  standard errors by which they should scatter, > 0; none where they state none
/// @param common  errors that they have in common, >= 0; none where there are none
/// @returns nothing for fewer than two
/// @throws InvalidArgument where sizes differ
std::optional<Repeats> DescribeRepeats(std::span<const double> values,
                                       std::span<const double> errors,
                                       std::span<const double> common = {});

}  // namespace mindahl::campaign
