#include "identification/diagnosis/main_strokes.h"

#include <algorithm>
#include <cmath>

namespace mindahl::identification {

std::vector<MainStroke> MainStrokes(std::span<const double> displacement,
                                    std::span<const std::size_t> reversals, double main_stroke) {
  std::vector<MainStroke> strokes;
  strokes.reserve(reversals.size() + 1);
  const auto add = [&](std::size_t begin, std::size_t end) {
    strokes.push_back({begin, end, displacement[end] > displacement[begin]});
  };
  std::size_t begin = 0;
  for (const std::size_t reversal : reversals) {
    add(begin, reversal);
    begin = reversal;
  }
  add(begin, displacement.size() - 1);
  const auto length = [&](const MainStroke& stroke) {
    return std::abs(displacement[stroke.end] - displacement[stroke.begin]);
  };
  double longest = 0.0;
  for (const MainStroke& stroke : strokes) longest = std::max(longest, length(stroke));
  std::erase_if(strokes, [&](const MainStroke& stroke) {
    return !(length(stroke) > 0) || length(stroke) < main_stroke * longest;
  });
  return strokes;
}

bool AnyComesBack(std::span<const MainStroke> strokes) {
  const auto rising = std::ranges::count_if(strokes, &MainStroke::rises);
  return rising > 1 || std::ssize(strokes) - rising > 1;
}

}  // namespace mindahl::identification
