#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "identification/problem/problem.h"
#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// A sample, in units of the data: what columns of omitted terms are made of.
struct Place {
  double displacement = 0.0;  // of a contact under an imposed force from where it is unloaded
  double time = 0.0;          // [s], or samples, from the record's middle
  double velocity = 0.0;
  double acceleration = 0.0;
  double rate = 0.0;       // of the whole response
  double curvature = 0.0;  // of the whole response, its second derivative by time
  double force = 0.0;  // of the contact, over the slip force; as it was read where it is imposed
  double peak = 0.0;   // largest |force| of all records
  double load_change = 0.0;  // of the measured load, over its mean
  double missed = 0.0;       // way since the displacement was last read anew, where it is repeated
  double asymmetry = 0.0;    // of the force over the slip force, its derivative by an asymmetry
  // The stroke:
  double direction = 1.0;  // of the excitation
  double change = 0.0;     // of the contact's response from end to end
  double progress = 0.0;   // fraction of that change, up to here
};

/// A column of an omitted term, of the response.
using DepartureColumn = double (*)(const Place&);

/// A way in which a record may depart from the model, to first order: a response in proportion to
/// one to four columns. Where there are fewer the rest is null.
struct Departure {
  std::string_view code;
  std::string_view group = {};  // of terms that fits it; empty where there is none
  std::array<DepartureColumn, 4> columns = {};
  std::array<DepartureColumn, 3> of_displacement = {};  // that answers an imposed force
  bool moves = false;          // `columns` move the contact, which responds with its memory
  std::string_view term = {};  // of a fit, that is the same: where it is not the group's name
};

/// An omitted term of a record: one of Departures(). Of one that noise may well have made only the
/// p-value; else the fit with it, by one linear step.
struct OmittedTerm : Cause {
  std::vector<Eigen::Index> places = {};  // of its columns
  double p_value = 1.0;                   // that noise alone makes it
  Eigen::VectorXd step = {};              // of θ, one a free parameter
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
                                     const Thresholds& thresholds, std::size_t most);

}  // namespace mindahl::identification
