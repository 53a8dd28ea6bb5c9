#include "io/thinning.h"

#include <algorithm>
#include <array>

#include "io/panel_drawing.h"

namespace mindahl::io {

std::vector<std::size_t> Thinned(const PlotSeries& series, std::size_t most) {
  const std::size_t size = series.x.size();
  std::vector<std::size_t> kept;
  if (size <= most) {
    for (std::size_t point = 0; point < size; ++point) kept.push_back(point);
    return kept;
  }
  std::vector<const std::vector<double>*> coordinates = {&series.x, &series.y};
  if (HasEnds(series.style)) coordinates.insert(coordinates.end(), {&series.lower, &series.upper});
  const std::size_t runs = std::max<std::size_t>(most / (2 * coordinates.size()), 1);
  for (std::size_t run = 0; run < runs; ++run) {
    const auto begin = static_cast<std::ptrdiff_t>(run * size / runs);
    const auto end = static_cast<std::ptrdiff_t>((run + 1) * size / runs);
    std::vector<std::size_t> extremes;
    for (const std::vector<double>* values : coordinates) {
      const auto [least, greatest] =
          std::minmax_element(values->begin() + begin, values->begin() + end);
      extremes.push_back(static_cast<std::size_t>(least - values->begin()));
      extremes.push_back(static_cast<std::size_t>(greatest - values->begin()));
    }
    std::ranges::sort(extremes);
    const auto repeated = std::ranges::unique(extremes);
    extremes.erase(repeated.begin(), repeated.end());
    kept.insert(kept.end(), extremes.begin(), extremes.end());
  }
  return kept;
}

std::vector<std::size_t> ThinnedCloud(const PlotSeries& series, std::size_t most) {
  const std::size_t size = series.x.size();
  std::vector<std::size_t> kept;
  if (size <= most) {
    for (std::size_t point = 0; point < size; ++point) kept.push_back(point);
    return kept;
  }
  const auto [least_x, greatest_x] = std::ranges::minmax_element(series.x);
  const auto [least_y, greatest_y] = std::ranges::minmax_element(series.y);
  const std::array extremes = {
      static_cast<std::size_t>(least_x - series.x.begin()),
      static_cast<std::size_t>(greatest_x - series.x.begin()),
      static_cast<std::size_t>(least_y - series.y.begin()),
      static_cast<std::size_t>(greatest_y - series.y.begin()),
  };
  const auto cell = [](double value, double least, double greatest, std::size_t cells) {
    if (!(greatest > least)) return std::size_t{0};
    const double share = value / (greatest - least) - least / (greatest - least);
    return std::min(static_cast<std::size_t>(share * static_cast<double>(cells)), cells - 1);
  };
  for (std::size_t cells = 512; cells >= 1; cells /= 2) {
    kept.assign(extremes.begin(), extremes.end());
    std::vector<bool> is_taken(cells * cells, false);
    for (std::size_t point = 0; point < size && kept.size() <= most; ++point) {
      const std::size_t at = cell(series.x[point], *least_x, *greatest_x, cells) * cells +
                             cell(series.y[point], *least_y, *greatest_y, cells);
      if (is_taken[at]) continue;
      is_taken[at] = true;
      kept.push_back(point);
    }
    if (kept.size() <= most) break;
  }
  std::ranges::sort(kept);
  const auto repeated = std::ranges::unique(kept);
  kept.erase(repeated.begin(), repeated.end());
  return kept;
}

}  // namespace mindahl::io
