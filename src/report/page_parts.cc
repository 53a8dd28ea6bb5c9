#include "report/page_parts.h"

#include <fmt/format.h>

#include <utility>

#include "mindahl/core/version.h"
#include "mindahl/io/html.h"

namespace mindahl::report {

using io::HtmlText;

std::string_view CssClass(Judgement judgement) {
  switch (judgement) {
    case Judgement::kGood:
      return "good";
    case Judgement::kPoor:
      return "poor";
    case Judgement::kBad:
      break;
  }
  return "bad";
}

std::string Paragraph(std::string_view text, std::string_view css_class) {
  if (text.empty()) return "";
  return css_class.empty() ? fmt::format("<p>{}</p>\n", HtmlText(text))
                           : fmt::format("<p class=\"{}\">{}</p>\n", css_class, HtmlText(text));
}

std::string Heading(std::string_view text) { return fmt::format("<h2>{}</h2>\n", HtmlText(text)); }

std::string SubHeading(std::string_view text) {
  return fmt::format("<h3>{}</h3>\n", HtmlText(text));
}

std::string SentenceList(const std::vector<std::string>& sentences) {
  std::string items;
  for (const std::string& sentence : sentences) {
    items += fmt::format("<li>{}</li>\n", HtmlText(sentence));
  }
  return items.empty() ? "" : fmt::format("<ul>\n{}</ul>\n", items);
}

std::string CommandBlock(std::string_view command) {
  return fmt::format("<pre><code>{}</code></pre>\n", HtmlText(command));
}

Cell Number(std::string text) { return {.text = std::move(text)}; }

Cell Words(std::string text, std::string_view css_class) {
  return {.text = std::move(text), .kind = Cell::Kind::kWords, .css_class = css_class};
}

Table::Table(std::string_view caption, std::initializer_list<std::string_view> columns) {
  head_ = fmt::format("<caption>{}</caption>\n<thead><tr>", HtmlText(caption));
  for (const std::string_view column : columns) {
    head_ += fmt::format("<th scope=\"col\">{}</th>", HtmlText(column));
  }
  head_ += "</tr></thead>\n";
}

void Table::Row(std::string_view name, const std::vector<Cell>& cells) {
  rows_ += fmt::format("<tr><th scope=\"row\">{}</th>", HtmlText(name));
  for (const Cell& cell : cells) {
    rows_ += fmt::format("<td class=\"{}{}{}\">{}</td>",
                         cell.kind == Cell::Kind::kNumber ? "number" : "words",
                         cell.css_class.empty() ? "" : " ", cell.css_class, HtmlText(cell.text));
  }
  rows_ += "</tr>\n";
}

std::string Table::Html() const {
  if (rows_.empty()) return "";
  return fmt::format("<div class=\"table\"><table>{}<tbody>\n{}</tbody></table></div>\n", head_,
                     rows_);
}

std::string VerdictBlock(std::string_view css_class, std::string_view word,
                         std::string_view sentence) {
  return fmt::format("<p class=\"verdict {}\"><strong>{}</strong>{}{}</p>\n", css_class,
                     HtmlText(word), sentence.empty() ? "" : ": ", HtmlText(sentence));
}

std::string ReproduceSection(const Provenance& provenance) {
  std::string html = Heading("To make this again");
  if (!provenance.command.empty()) html += CommandBlock(provenance.command);
  html += Paragraph(fmt::format("mindahl {}", Version()));
  Table inputs("what was read", {"file", "SHA-256 of its bytes"});
  for (const InputFile& input : provenance.inputs) {
    inputs.Row(input.name, {Words(input.sha256.value_or("no regular file, read once"))});
  }
  html += inputs.Html();
  Table options("options, those of a configuration file too", {"option", "value"});
  for (const auto& [name, value] : provenance.options) options.Row(name, {Words(value)});
  return html + options.Html();
}

}  // namespace mindahl::report
