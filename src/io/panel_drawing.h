#pragma once

#include <cstddef>
#include <string>
#include <string_view>
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

/// True if a series of that style has lower and upper ends.
constexpr bool HasEnds(PlotStyle style) {
  return style == PlotStyle::kIntervals || style == PlotStyle::kBand;
}

/// @param where  the panel, for messages
/// @throws InvalidArgument naming the panel and series for what DrawPanel() does not draw
void RequireDrawable(const PlotPanel& panel, const std::string& where);

/// How the series of a panel differ: in colour, and in the shape of their markers; beyond the first
/// six also in dashes and in filled markers. A line without a label looks like the series before
/// it.
struct SeriesLook {
  std::string colour;     ///< class of the style: s0 … s5, or h0 … h7 of a shade
  std::size_t shape = 0;  ///< marker, 0 … 5
  std::size_t round = 0;  ///< how often the colours were used before, 0 … 2
};
std::vector<SeriesLook> LooksOf(const PlotPanel& panel);

/// Draws the symbol of a series in the legend, in 26 x 12 px.
std::string LegendSymbol(PlotStyle style, const SeriesLook& look);

/// Room [px] above the axes of a drawing, for the label of the vertical axis, and below them.
inline constexpr double kAboveAxes = 30;
inline constexpr double kBelowAxes = 52;

/// Draws a panel without title and legend as elements of SVG, in `width` and
/// kAboveAxes + axes_height + kBelowAxes [px]. Text stays text, colours are classes.
/// @param panel  RequireDrawable()
/// @param most_points  of all series, over which they are spread evenly
std::string DrawPanel(const PlotPanel& panel, double width, double axes_height,
                      std::size_t most_points);

/// Holds a panel as a page of HTML shows it: the elements of an inline SVG, and its legend as text
/// with the symbols in 26 x 12 px. Nothing is loaded and no script is run; colours are classes of
/// the page's style, which follows the scheme of the reader, light or dark, and is light in print.
struct PageDrawing {
  struct Entry {
    std::string symbol;
    std::string label;
  };
  int width = 0;   ///< of the SVG's coordinates [px], where it is not scaled to the page
  int height = 0;  ///< [px]
  std::string elements;
  std::vector<Entry> legend = {};  ///< of the series that have a label
};

/// Draws a panel for a page. At most 6000 points are drawn, evenly over the series, of which each
/// is thinned as WritePlot() thins: no peak is lost, and a page has a size.
/// @param panel  as WritePlot() takes it; its height is over half the width
/// @param name   for messages
/// @throws InvalidArgument as WritePlot()
PageDrawing DrawForPage(const PlotPanel& panel, std::string_view name);

}  // namespace mindahl::io
