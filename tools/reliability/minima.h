#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

/// Whether a fit ends in the least of the minima: beside ceres::Solve of the unprojected problem
/// from the truth and from random starts.
namespace mindahl::reliability {

/// What became of the problems of one kind.
struct MinimaTally {
  std::string_view kind;
  std::size_t problems = 0;
  std::size_t not_converged = 0;
  /// Fits whose cost is above the judge's by more than 1e-6 of it, …
  std::size_t worse = 0;
  /// … by more than noise can hide, 2 ln Λ > 1, …
  std::size_t told = 0;
  /// … and whose σ, α and Tc are all called identifiable all the same.
  std::size_t told_and_identifiable = 0;
  /// Problems in which no run of the judge came as low as the fit, within 1e-6.
  std::size_t judge_worse = 0;
  double largest = 0.0;  ///< 2 ln Λ of the judge against the fit
};

/// Names of the kinds, in the order of the table.
std::vector<std::string_view> KindsOfMinima();

/// Fits `problems` loops of a kind, the first with this seed.
/// @throws InvalidArgument where there is no kind of that name
MinimaTally MeasureMinima(std::string_view kind, std::size_t problems, std::uint64_t seed);

}  // namespace mindahl::reliability
