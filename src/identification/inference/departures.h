#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "identification/problem/problem.h"

namespace mindahl::identification {

/// A way in which a record may depart from the model, to first order: forces in proportion to one
/// to three columns.
struct Departure {
  std::string_view code;
  std::string_view meaning;
  std::string_view group = {};  // of terms that fits it; empty where there is none
  /// Names the term of a fit that is the same: it is not looked for where that is fitted.
  std::string_view term = {};
};

/// Holds the columns of all omitted terms at a solution.
struct DepartureColumns {
  Eigen::MatrixXd columns;         // weighted, rows as the Jacobian's
  std::vector<std::size_t> of;     // of each column: its place in Departures()
  std::vector<std::size_t> group;  // of each: those of one term, or one covariate, are one
  std::size_t groups = 0;
  std::vector<std::size_t> covariates;  // of the last columns: their place in ScaledRecords
};

/// Returns them in the order in which they are given up where a record has few samples.
std::span<const Departure> Departures();

/// @param most  columns that are wanted; fewer where the next term's do not fit
DepartureColumns ColumnsOfDepartures(const Problem& problem, std::span<const double> theta,
                                     Response& response, std::size_t most);

/// Omitted terms of a displacement that responds to an imposed force, to first order: the same
/// codes, where they have a meaning, as displacements in proportion to one to three columns.
/// @param most  columns that are wanted; fewer where the next term's do not fit
DepartureColumns ColumnsOfDisplacementDepartures(const Problem& problem,
                                                 std::span<const double> theta, Response& response,
                                                 std::size_t most);

}  // namespace mindahl::identification
