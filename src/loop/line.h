#pragma once

#include <span>

namespace mindahl::loop {

/// A least-squares line through values against numbers that are not all the same.
struct Line {
  double mean = 0.0;  // of the values
  double slope = 0.0;
  double slope_error = 0.0;
  double deviation = 0.0;  // standard, of the values from it
  double degrees_of_freedom = 0.0;
};

/// @param values  three or more
Line LineThrough(std::span<const double> numbers, std::span<const double> values);

}  // namespace mindahl::loop
