#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mindahl/io/plot.h"

namespace mindahl::io {

/// Returns the text that a page of HTML shows as it is, between tags or in quotes: & < > " ' are
/// escaped; what is not UTF-8 is left out, and control characters but for the line feed become
/// U+FFFD.
std::string HtmlText(std::string_view text);

/// Holds a series of a legend: its symbol as elements of SVG in 26 x 12 px, and its label.
struct LegendEntry {
  std::string symbol;
  std::string label;
};
/// Returns the series that have a label.
std::vector<LegendEntry> LegendOf(const PlotPanel& panel);

/// Room [px] above the axes of a drawing, for the label of the vertical axis, and below them.
inline constexpr double kAboveAxes = 30;
inline constexpr double kBelowAxes = 52;

/// Draws a panel without its title and legend as elements of SVG, in `width` and kAboveAxes +
/// axes_height + kBelowAxes [px]. Colours are classes of a style.
/// @param most_points  of all series, over which they are spread evenly
/// @throws InvalidArgument as WritePlot()
std::string DrawPanel(const PlotPanel& panel, double width, double axes_height,
                      std::size_t most_points);

}  // namespace mindahl::io
