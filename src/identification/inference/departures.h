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
  std::string_view meaning;  // of the size, with its sign; L is the half range of displacement
  std::string_view unit;     // of the size, which is the first column's; empty where it says little
  std::string_view group = {};  // of terms that fits it; empty where there is none
  /// Names the term of a fit that is the same: it is not looked for where that is fitted.
  std::string_view term = {};
  std::string_view unit_by_sample = {};  // where records have no time; empty where it is the same
  /// No size is negative, as none of a mass: a negative one is no cause, unless a rig is fitted,
  /// which is too soft then.
  bool is_positive = false;
  /// The column is in proportion to the square of the size.
  bool is_square = false;
  /// Difference of the force from the mean in parts of a record with a contact of their own, over
  /// the size.
  double apart = 0.0;
  /// Codes of causes whose columns this one has too, or nearly: of two that explain the same the
  /// simpler is named.
  std::array<std::string_view, 2> simpler = {};
};

/// Holds the columns of all omitted terms at a solution.
struct DepartureColumns {
  Eigen::MatrixXd columns;         // weighted, rows as the Jacobian's
  std::vector<std::size_t> of;     // of each column: its place in Departures()
  std::vector<std::size_t> group;  // of each: those of one term, or one covariate, are one
  std::size_t groups = 0;
  std::vector<std::size_t> covariates;  // of the last columns: their place in ScaledRecords
  std::vector<double> unit_of_size;     // of each: what a factor of one is, in the term's unit
  bool timed = true;                    // else sizes are by sample
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
