#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "identification/inference/places.h"
#include "identification/problem/problem.h"

namespace mindahl::identification {

/// A column of an omitted term, of the response.
struct DepartureColumn {
  double (*value)(const Place&) = nullptr;
  bool is_motion = false;  // the value moves the contact, which responds with its memory
};

/// A way in which a record may depart from the model, to first order: a response in proportion to
/// one to four columns. Without a value there is no such column.
struct Departure {
  std::string_view code;
  std::string_view group = {};  // of terms that fits it; empty where there is none
  /// Names the term of a fit that is the same, if not as the group: it is not looked for where that
  /// is fitted.
  std::string_view term = {};
  std::array<DepartureColumn, 4> columns = {};
  std::array<DepartureColumn, 3> of_displacement = {};  // that answers an imposed force

  [[nodiscard]] std::span<const DepartureColumn> ColumnsOf(loop::Channel imposed) const {
    if (imposed == loop::Channel::kForce) return of_displacement;
    return columns;
  }
};

/// An omitted term of a record: one of Departures().
struct OmittedTerm {
  const Departure* departure = nullptr;
  std::vector<Eigen::Index> places = {};  // of its columns
  // The fit with it, by one linear step; only the p-value of one that noise may well have made:
  double p_value = 1.0;           // that noise alone makes it
  double delta_aicc = 0.0;        // against the fit without
  double explains = 0.0;          // fraction of the sum of squares
  std::vector<double> step = {};  // of θ, one a free parameter
};

/// Holds the columns of all omitted terms at a solution.
struct DepartureColumns {
  Eigen::MatrixXd columns;  // weighted, rows as the Jacobian's
  std::vector<OmittedTerm> terms;
};

/// Returns them in the order in which they are given up where a record has few samples.
std::span<const Departure> Departures();

/// Returns the columns that are not zero of terms that are not fitted.
/// @param most  columns that are wanted; fewer where the next term's do not fit
DepartureColumns ColumnsOfDepartures(const Problem& problem, std::span<const double> theta,
                                     const Thresholds& thresholds, Response& response,
                                     std::size_t most);

}  // namespace mindahl::identification
