#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace mindahl::identification {

/// Names the variable on which the force along a branch depends.
enum class MemoryVerdict {
  kMasing,     ///< the way since the last reversal that is remembered, of whatever backbone
  kDahl,       ///< the force itself: slope = g(sT), of whatever g
  kNeither,    ///< the record contradicts both
  kUndecided,  ///< it contradicts neither
};

/// Parts of a record that one curve would have to run through.
struct MemoryComparison {
  /// Stable, for scripts; slopes after reversals are those of eq. 12 of Peyret et al. (2017), σ by
  /// Masing's rule, σ(1 + T*/Tc)^α by Dahl's own law: "virgin_branch", "directions", "amplitudes",
  /// "slope_at_reversal", "return_point", "other_law"
  std::string_view code;
  double p_value = 1.0;       ///< chance of such a difference under Masing's memory, by noise
  double dahl_p_value = 1.0;  ///< likewise of Dahl's
  double size = 0.0;          ///< [N] rms over the record of what is beyond Masing's memory
};

/// Tests whether a record follows Masing's memory, Dahl's, or neither, by comparing its branches
/// with each other and with the virgin one. The law's shape is not presumed: either memory is given
/// the backbone that fits best.
struct MemoryTest {
  MemoryVerdict verdict = MemoryVerdict::kUndecided;
  double p_value = 1.0;                       ///< under Masing's memory, all comparisons together
  double dahl_p_value = 1.0;                  ///< under Dahl's memory, likewise
  std::vector<MemoryComparison> comparisons;  ///< those that the record has; may be empty
};

/// Codes of all comparisons, in the order of a test.
std::vector<std::string_view> MemoryComparisonCodes();

}  // namespace mindahl::identification
