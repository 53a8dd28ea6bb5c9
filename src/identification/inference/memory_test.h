#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "identification/inference/local.h"
#include "identification/inference/noise.h"
#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// Holds the columns of the test of a law's memory, weighted, a row a sample.
struct MemoryColumns {
  /// Other shapes of the law, the same on all branches: of the backbone where memory is Masing's,
  /// of the slope as a function of the force where it is Dahl's.
  Eigen::MatrixXd shape;
  Eigen::MatrixXd differences;             // between branches
  std::vector<std::string_view> of;        // of each of these: the code of its comparison
  std::vector<std::string_view> compared;  // codes of those that the record has, in their order
};

/// How many columns a record pays for.
struct MemoryResolution {
  std::size_t shapes = 0;
  std::size_t waves = 0;  // of a difference along a branch; 0: nothing is compared
};
MemoryResolution ResolutionOf(const Problem& problem);

/// Codes of comparisons.
inline constexpr std::string_view kVirginBranch = "virgin_branch";
inline constexpr std::string_view kDirections = "directions";
inline constexpr std::string_view kAmplitudes = "amplitudes";
inline constexpr std::string_view kSlopeAtReversal = "slope_at_reversal";
inline constexpr std::string_view kReturnPoint = "return_point";
inline constexpr std::string_view kOtherLaw = "other_law";

/// @param problem  of one load and without a lag; the law's memory is that of its model
/// @param other    weighted, by how much the other law's fitted force is above; may be empty
MemoryColumns ColumnsOfMemory(const Problem& problem, std::span<const double> theta,
                              Response& response, const MemoryResolution& resolution,
                              const Eigen::VectorXd& other);

/// A law that was fitted, linearized in all free parameters.
struct FittedLaw {
  const Problem* problem;
  const Solution* solution;
  Linearization at;
};

/// True if branches may be copies of each other: an imposed displacement, a constant load, no lag
/// and no load series.
bool CanCompareBranches(const Problem& problem);

/// Compares branches with each other, under each law with a free shape: the differences that
/// are left are held against the noise (ColumnTest).
/// @param masing  with Masing's memory
/// @param dahl    with Dahl's; null where the two are one curve
MemoryTest TestMemory(const FittedLaw& masing, const FittedLaw* dahl, const Noise& noise,
                      const DisplacementEffect& displacement, const Thresholds& thresholds,
                      Response& response);

/// @param p_value       that noise makes the discrepancy from Masing's memory
/// @param dahl_p_value  likewise
MemoryVerdict VerdictOf(double p_value, double dahl_p_value, const Thresholds& thresholds);

}  // namespace mindahl::identification
