#pragma once

#include <cstddef>
#include <vector>

#include "mindahl/io/plot.h"

namespace mindahl::io {

/// Indices of the points to draw, in order: all up to `most`; of more than these, runs of
/// consecutive points are cut and of each the points with the least and greatest x and y kept, of
/// a band also those with its outermost ends.
/// @param most  >= 8
std::vector<std::size_t> Thinned(const PlotSeries& series, std::size_t most);

/// Thins, likewise, a cloud of points, whose order does not matter: of those in one cell of a grid
/// the first is kept, and the least and greatest x and y. The grid is as fine as `most` allows, at
/// most 512 cells wide: what is left out would lie upon what is kept.
/// @param most  >= 8
std::vector<std::size_t> ThinnedCloud(const PlotSeries& series, std::size_t most);

}  // namespace mindahl::io
