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

/// @param main_stroke  least share of the longest
std::vector<MainStroke> MainStrokes(std::span<const double> displacement,
                                    std::span<const std::size_t> reversals, double main_stroke);

/// Is there a second one in either direction, in which what is repeatable would come back?
bool AnyComesBack(std::span<const MainStroke> strokes);

}  // namespace mindahl::identification
