#include "report/page_parts.h"

#include <fmt/format.h>

#include <cctype>
#include <cstddef>
#include <utility>

#include "io/html.h"
#include "mindahl/core/version.h"

namespace mindahl::report {

namespace {

bool IsLetter(char character) { return std::isalnum(static_cast<unsigned char>(character)) != 0; }

/// Returns the text of which no option of the command line is broken at its hyphens.
std::string Prose(std::string_view text) {
  std::string html;
  std::size_t said = 0;
  for (std::size_t at = text.find("--"); at != std::string_view::npos; at = text.find("--", at)) {
    std::size_t end = at + 2;
    while (end < text.size() && (IsLetter(text[end]) || text[end] == '-')) ++end;
    const bool is_option =
        end > at + 2 && IsLetter(text[at + 2]) && (at == 0 || !IsLetter(text[at - 1]));
    if (is_option) {
      html += io::HtmlText(text.substr(said, at - said));
      html += fmt::format("<span class=\"option\">{}</span>", text.substr(at, end - at));
      said = end;
    }
    at = end;
  }
  return html + io::HtmlText(text.substr(said));
}

/// Returns a name that a narrow screen breaks at its underscores and points, not within words.
std::string HtmlName(std::string_view text) {
  std::string html;
  for (const char character : Prose(text)) {
    html += character;
    if (character == '_' || character == '.') html += "<wbr>";
  }
  return html;
}

}  // namespace

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
  return css_class.empty() ? fmt::format("<p>{}</p>\n", Prose(text))
                           : fmt::format("<p class=\"{}\">{}</p>\n", css_class, Prose(text));
}

std::string Heading(std::string_view text) { return fmt::format("<h2>{}</h2>\n", Prose(text)); }

std::string SubHeading(std::string_view text) { return fmt::format("<h3>{}</h3>\n", Prose(text)); }

std::string SentenceList(const std::vector<std::string>& sentences) {
  std::string items;
  for (const std::string& sentence : sentences) {
    items += fmt::format("<li>{}</li>\n", Prose(sentence));
  }
  return items.empty() ? "" : fmt::format("<ul>\n{}</ul>\n", items);
}

std::string CommandBlock(std::string_view command) {
  return fmt::format("<pre><code>{}</code></pre>\n", Prose(command));
}

Cell Number(std::string text) { return {.text = std::move(text)}; }

Cell Words(std::string text, std::string_view css_class) {
  return {.text = std::move(text), .kind = Cell::Kind::kWords, .css_class = css_class};
}

Table::Table(std::string_view caption, std::initializer_list<std::string_view> columns) {
  head_ = fmt::format("<caption>{}</caption>\n<thead><tr>", Prose(caption));
  for (const std::string_view column : columns) {
    head_ += fmt::format("<th scope=\"col\">{}</th>", Prose(column));
  }
  head_ += "</tr></thead>\n";
}

void Table::Row(std::string_view name, const std::vector<Cell>& cells) {
  rows_ += fmt::format("<tr><th scope=\"row\">{}</th>", HtmlName(name));
  for (const Cell& cell : cells) {
    rows_ += fmt::format("<td class=\"{}{}{}\">{}</td>",
                         cell.kind == Cell::Kind::kNumber ? "number" : "words",
                         cell.css_class.empty() ? "" : " ", cell.css_class, Prose(cell.text));
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
                     Prose(word), sentence.empty() ? "" : ": ", Prose(sentence));
}

std::string ReproduceSection(const Provenance& provenance) {
  std::string html = Heading("How to reproduce this page");
  if (!provenance.command.empty()) html += CommandBlock(provenance.command);
  html += Paragraph(fmt::format("mindahl {}", Version()));
  Table inputs("files read", {"file", "SHA-256 of its bytes"});
  for (const InputFile& input : provenance.inputs) {
    inputs.Row(input.name, {Words(input.sha256.value_or("not a regular file, read once"))});
  }
  html += inputs.Html();
  Table options("options, including those of a configuration file", {"option", "value"});
  for (const auto& [name, value] : provenance.options) options.Row(name, {Words(value)});
  return html + options.Html();
}

}  // namespace mindahl::report
