#pragma once

#include <string>
#include <string_view>

#include "mindahl/io/plot.h"

namespace mindahl::io {

/// Returns the text that a page of HTML shows as it is, between tags or in quotes: & < > " ' are
/// escaped; what is not UTF-8, and control characters but for the line feed, become U+FFFD.
std::string HtmlText(std::string_view text);

/// Describes a figure in words, also for readers who do not see it.
struct FigureText {
  std::string id;           ///< identifies the element in its page, letters, digits and '-'
  std::string title;        ///< above the figure
  std::string description;  ///< how to read it, under the title
};

/// Returns a panel as a figure element with its drawing as inline SVG and a legend: nothing is
/// loaded and no script is run. Text stays text; colours are classes of FigureStyle(), which
/// follows the scheme of the reader, light or dark, and is light in print.
///
/// At most 6000 points are drawn, evenly over the series, of which each is thinned as WritePlot()
/// thins: no peak is lost, and a page has a size.
/// @param panel  as WritePlot() takes it; its height is over half the width
/// @throws InvalidArgument as WritePlot()
std::string HtmlFigure(const PlotPanel& panel, const FigureText& text);

/// Rules of CSS: of HtmlFigure(), and the variables --ink, --faint, --paper, --grid, --accent,
/// --good, --poor and --bad for the rest of a page.
std::string_view FigureStyle();

/// Returns a whole page, HTML 5, self-contained: it may load nothing, by a policy for the browser,
/// and has no script.
/// @param title  plain text
/// @param body   HTML, from the first heading on
std::string HtmlPage(std::string_view title, std::string_view body);

}  // namespace mindahl::io
