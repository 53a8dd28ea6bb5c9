#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "mindahl/io/plot.h"

namespace mindahl::io {

/// Returns the text that a page of HTML shows as it is, between tags or in quotes: & < > " ' are
/// escaped; what is not UTF-8 is left out, and control characters but for the line feed become
/// U+FFFD.
std::string HtmlText(std::string_view text);

/// Elements of SVG, whose colours are classes of a style, and the height [px] that they fill.
struct Drawing {
  std::string elements;
  double height = 0.0;
};

/// Draws a panel with its title and legend, in a width in pixels.
/// @param most_points  of all series, over which they are spread evenly
/// @throws InvalidArgument as WritePlot()
Drawing DrawPanel(const PlotPanel& panel, double width, std::size_t most_points);

}  // namespace mindahl::io
