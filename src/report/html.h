#pragma once

#include "mindahl/io/plot.h"
#include "report/statements.h"

// Parts of the pages, as HTML 5. Whatever is called a text, caption or sentence is escaped; with
// page.cc, these are the only files that write markup.
namespace mindahl::report {

/// Returns a page, self-contained: a policy for the browser forbids loading; there is no script.
/// @param body  the parts below, in their order
/// @param command  that makes the page again; "" where there was none
std::string PageHtml(std::string_view title, std::string_view body, std::string_view command);

/// Returns parts under a heading; "" without any.
std::string SectionHtml(std::string_view heading, const std::string& body);

std::string ParagraphHtml(std::string_view text);
std::string ListHtml(const std::vector<std::string>& sentences);
std::string VerdictHtml(std::string_view css_class, std::string_view word,
                        std::string_view sentence);

/// Holds a row of a table.
struct TableLine {
  std::string head;
  std::vector<std::string> cells;
  std::string_view css_class = {};  ///< style of its head
  std::string address = {};         ///< to which its head leads; "" none
};
/// Returns a table; "" without lines. Columns need not have names.
std::string TableHtml(std::string_view caption, const std::vector<std::string>& names,
                      const std::vector<TableLine>& lines);

/// Returns a figure of a panel, with its legend.
/// @param id  names it in its page: letters, digits, '_' and '-'
std::string FigureHtml(std::string_view id, std::string_view title, std::string_view text,
                       const io::PlotPanel& panel);
/// Returns a figure of the elements of an inline SVG, 560 px wide.
std::string FigureHtml(std::string_view id, std::string_view title, std::string_view text,
                       int height, std::string_view elements);
/// Returns figures, or tables, side by side where there is room; "" without any.
std::string SideBySide(std::string_view parts);

}  // namespace mindahl::report
