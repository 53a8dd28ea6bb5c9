#pragma once

#include <span>
#include <vector>

#include "identification/problem/problem.h"

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

/// Returns those of every sample at θ.
/// @param held_readings  fraction of the readings that repeat the last one, of a held displacement
std::vector<Place> PlacesOf(const Problem& problem, std::span<const double> theta,
                            double held_readings, Response& response);

}  // namespace mindahl::identification
