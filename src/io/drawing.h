#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "mindahl/io/plot.h"

namespace mindahl::io {

/// Returns the text that a page of HTML shows as it is, between tags or in quotes: & < > " ' are
/// escaped, what is not UTF-8 is left out, and control characters but line feeds become U+FFFD.
std::string HtmlText(std::string_view text);

/// The style of the elements of a drawing but for their colours, which a page and a file choose.
inline constexpr std::string_view kShapes =
    ".grid,.axis,.mark,.line,.dots,.marker{fill:none}"
    ".axis{stroke-width:1.2}.mark{stroke-width:1.3;stroke-dasharray:5 4}"
    ".line,.dots,.marker{stroke:currentColor}"
    ".line{stroke-width:1.7;stroke-linejoin:round;stroke-linecap:round}"
    ".dots,.marker{stroke-width:3.2;stroke-linecap:round}.marker{stroke-width:7}"
    ".area{fill:currentColor;fill-opacity:.22}.line.more{stroke-dasharray:10 5}\n";

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
