#include "report/html.h"

#include <fmt/format.h>

#include "io/drawing.h"
#include "mindahl/core/version.h"
#include "report/style.h"

namespace mindahl::report {

using io::HtmlText;

constexpr int kWidth = 560;  // [px] of a figure

std::string PageHtml(std::string_view title, std::string_view body, std::string_view command) {
  const std::string again =
      command.empty() ? "" : fmt::format("<pre><code>{}</code></pre>\n", HtmlText(command));
  return fmt::format(R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="generator" content="mindahl">
<link rel="icon" href="data:,">
<title>{}</title>
<style>
{}{}</style>
</head>
<body>
<header><h1>{}</h1></header>
<main>
{}<h2>How to reproduce this page</h2>
{}<p>mindahl {}</p>
</main>
</body>
</html>
)",
                     HtmlText(title), io::kShapes, kStyle, HtmlText(title), body, again,
                     HtmlText(Version()));
}

std::string SectionHtml(std::string_view heading, const std::string& body) {
  return body.empty() ? "" : fmt::format("<h2>{}</h2>\n{}", HtmlText(heading), body);
}

std::string ParagraphHtml(std::string_view text) {
  return fmt::format("<p>{}</p>\n", HtmlText(text));
}

std::string ListHtml(const std::vector<std::string>& sentences) {
  if (sentences.empty()) return "";
  std::string html = "<ul>\n";
  for (const std::string& each : sentences) html += fmt::format("<li>{}</li>\n", HtmlText(each));
  return html + "</ul>\n";
}

std::string VerdictHtml(std::string_view css_class, std::string_view word,
                        std::string_view sentence) {
  return fmt::format("<p class=\"verdict {}\"><strong>{}</strong>{}{}</p>\n", css_class,
                     HtmlText(word), sentence.empty() ? "" : ": ", HtmlText(sentence));
}

std::string TableHtml(std::string_view caption, const std::vector<std::string>& names,
                      const std::vector<TableLine>& lines) {
  if (lines.empty()) return "";
  std::string html = "<div class=\"table\"><table>";
  if (!caption.empty()) html += fmt::format("<caption>{}</caption>", HtmlText(caption));
  if (!names.empty()) html += "\n<thead><tr>";
  for (const std::string& name : names)
    html += fmt::format("<th scope=\"col\">{}</th>", HtmlText(name));
  html += names.empty() ? "\n<tbody>\n" : "</tr></thead>\n<tbody>\n";
  for (const TableLine& line : lines) {
    html += "<tr><th scope=\"row\"";
    if (!line.css_class.empty()) html += fmt::format(" class=\"{}\"", line.css_class);
    html += line.address.empty()
                ? fmt::format(">{}</th>", HtmlText(line.head))
                : fmt::format("><a href=\"{}\">{}</a></th>", line.address, HtmlText(line.head));
    for (const std::string& cell : line.cells) {
      // Letters break anywhere, numbers nowhere.
      const char* const kind = cell.find_first_of("0123456789") == 0 ? "number" : "words";
      html += fmt::format("<td class=\"{}\">{}</td>", kind, HtmlText(cell));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string FigureHtml(std::string_view id, std::string_view title, std::string_view text,
                       const io::PlotPanel& panel) {
  const io::Drawing drawing = io::DrawPanel(panel, kWidth, /*most_points=*/6000);
  return FigureHtml(id, title, text, static_cast<int>(drawing.height), drawing.elements);
}

std::string FigureHtml(std::string_view id, std::string_view title, std::string_view text,
                       int height, std::string_view elements) {
  return fmt::format(R"(<figure id="{0}">
<h2 id="{0}-title">{1}</h2>
<p id="{0}-text">{2}</p>
<svg class="plot" viewBox="0 0 {3} {4}" role="img" aria-labelledby="{0}-title {0}-text">{5}</svg>
</figure>
)",
                     id, HtmlText(title), HtmlText(text), kWidth, height, elements);
}

std::string SideBySide(std::string_view parts) {
  return parts.empty() ? "" : fmt::format("<div class=\"figures\">\n{}</div>\n", parts);
}

}  // namespace mindahl::report
