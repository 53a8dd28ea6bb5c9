#pragma once

#include <span>
#include <vector>

#include "identification/problem/problem.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::identification {

/// A sample, or the origin of a branch on the one before, in units of the data: what columns of
/// omitted terms are made of.
struct Place {
  double displacement = 0.0;  // of a contact under an imposed force from where it is unloaded
  double time = 0.0;          // from the record's middle, in a unit that all records share
  double velocity = 0.0;
  double acceleration = 0.0;
  double rate = 0.0;       // of the whole response
  double curvature = 0.0;  // of the whole response, its second derivative by time
  double force = 0.0;  // of the contact, over the slip force; as it was read where it is imposed
  double peak = 0.0;   // largest |force| of all records
  double load_change = 0.0;  // of the measured load, over its mean
  double missed = 0.0;       // way since the displacement was last read anew, where it is repeated
  double asymmetry = 0.0;    // of the force over the slip force, its derivative by an asymmetry
  // The branch, with forces of the contact over the slip force and under the mean load:
  double imposed = 0.0;  // of the two channels
  double carried = 0.0;
  double slope = 0.0;      // ∂carried/∂displacement
  double gain = 1.0;       // by what is carried at the branch's origin
  double direction = 1.0;  // of the branch
  bool sets_out = false;   // on the virgin curve, in its first direction
  bool virgin = false;     // on the virgin curve
  double span = 1.0;       // of the branch, over that of the virgin curve
  double reach = 1.0;      // what it has to go from its origin to slip
  double origin = 0.0;     // displacement
  double origin_carried = 0.0;

  /// Returns the fraction of the way to slip that the branch has covered.
  [[nodiscard]] double Mobilised() const;
};

/// Holds the places of a record's samples and of its branches' origins.
struct RecordPlaces {
  const models::LoadingPath* path = nullptr;  // of the response
  std::vector<Place> samples;
  std::vector<Place> origins;  // each on its parent
  Place extreme;               // the upper one of the steady loop, on the branch from the lower one
  bool starts_at_zero = false;  // columns begin at zero: what they begin at is an offset's
};

/// Returns those of every record at θ. Turning points that were put in have no time of their own.
/// Valid until the response changes.
/// @param held_readings  fraction of the readings that repeat the last one, of a held displacement
std::vector<RecordPlaces> PlacesOf(const Problem& problem, std::span<const double> theta,
                                   double held_readings, Response& response);

/// Fills a column of forces that arise along the branches, to first order: what one is at a sample
/// is what it is where the sample's branch starts, and what was added on the branch since.
/// @param value  what is added on a branch up to a place
void FillAlongBranches(double (*value)(const Place&), const RecordPlaces& record,
                       std::span<double> column);

}  // namespace mindahl::identification
