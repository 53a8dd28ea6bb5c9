#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace mindahl::identification {

/// A stroke about as long as the record's longest.
struct MainStroke {
  std::size_t begin = 0;
  std::size_t end = 0;  // the sample where it ends
  bool rises = false;
};

/// @param main_stroke  least fraction of the longest
std::vector<MainStroke> MainStrokes(std::span<const double> displacement,
                                    std::span<const std::size_t> reversals, double main_stroke);

/// True if either direction has a second stroke, in which a repeatable residual would recur.
bool AnyComesBack(std::span<const MainStroke> strokes);

}  // namespace mindahl::identification
