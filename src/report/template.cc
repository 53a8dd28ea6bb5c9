#include "report/template.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstddef>
#include <functional>
#include <kainjow/mustache.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "io/drawing.h"
#include "mindahl/core/version.h"
#include "report/templates.h"

namespace mindahl::report {

namespace {

namespace mustache = kainjow::mustache;

bool IsLetter(char character) { return std::isalnum(static_cast<unsigned char>(character)) != 0; }

/// Returns a text of which no option of the command line is broken at its hyphens; a name, which
/// has no blanks, is broken at its underscores and before its extension.
std::string Prose(const std::string& text) {
  std::string html;
  std::size_t said = 0;
  const auto say_until = [&](std::size_t end) {
    html += io::HtmlText(std::string_view(text).substr(said, end - said));
    said = end;
  };
  const bool is_name = text.find(' ') == std::string::npos;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text.compare(at, 2, "--") == 0) {
      std::size_t end = at + 2;
      while (end < text.size() && (IsLetter(text[end]) || text[end] == '-')) ++end;
      if (end > at + 2 && IsLetter(text[at + 2]) && (at == 0 || !IsLetter(text[at - 1]))) {
        say_until(at);
        html += "<span class=\"option\">";
        say_until(end);
        html += "</span>";
      }
      at = end - 1;
    } else if (is_name && (text[at] == '_' || text[at] == '.') && at + 1 < text.size() &&
               std::isdigit(static_cast<unsigned char>(text[at + 1])) == 0) {
      say_until(at + 1);
      html += "<wbr>";
    }
  }
  say_until(text.size());
  return html;
}

mustache::data DataOf(const Json& value) {
  if (value.is_object()) {
    mustache::data object;
    for (const auto& [key, member] : value.items()) object[key] = DataOf(member);
    return object;
  }
  if (value.is_array()) {
    if (value.empty()) return false;
    mustache::data rows(mustache::data::type::list);
    for (const Json& element : value) rows << DataOf(element);
    return {"rows", rows};
  }
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_null()) return false;
  if (!value.is_string()) return value.dump();
  const auto& text = value.get_ref<const std::string&>();
  if (text.empty()) return false;
  return text;
}

/// @param file  of src/report/templates
const mustache::data& TemplateFile(const std::string& file) {
  static const mustache::data files_by_name = [] {
    mustache::data files;
    for (const auto& [name, text] : kTemplates) files[std::string(name)] = std::string(text);
    return files;
  }();
  const mustache::data* const found = files_by_name.get(file);
  if (found == nullptr) throw std::logic_error(fmt::format("there is no template '{}'", file));
  return *found;
}

/// Finds members and partials, of which a template that names one that is not there has a mistake.
class Context : public mustache::context<std::string> {
 public:
  Context(std::string_view name, const mustache::data& data) : context(&data), name_(name) {}

  const mustache::data* get(const std::string& name) const override {
    const mustache::data* const found = context::get(name);
    if (found == nullptr) {
      throw std::logic_error(fmt::format("the data of the page '{}' have no '{}'", name_, name));
    }
    return found;
  }
  const mustache::data* get_partial(const std::string& name) const override {
    return &TemplateFile(name + ".html");
  }

 private:
  std::string_view name_;
};

/// @param escape  what text becomes
std::string RenderTemplate(std::string_view name, const mustache::data& data,
                           const std::function<std::string(const std::string&)>& escape) {
  mustache::mustache page(TemplateFile(fmt::format("{}.html", name)).string_value());
  page.set_custom_escape(escape);
  Context context(name, data);
  std::ostringstream html;
  page.render(context, html);
  if (!page.is_valid()) {
    throw std::logic_error(fmt::format("template '{}': {}", name, page.error_message()));
  }
  return std::move(html).str();
}

}  // namespace

std::string RenderPage(std::string_view name, const Json& data) {
  mustache::data frame;
  frame["title"] = DataOf(data.at("title"));
  frame["style"] = TemplateFile("style.css").string_value();
  frame["body"] = RenderTemplate(name, DataOf(data), Prose);
  // A title has no elements: only what is markup is escaped in it.
  return RenderTemplate("layout", frame,
                        [](const std::string& text) { return io::HtmlText(text); });
}

std::string_view CssClass(Judgement judgement) {
  switch (judgement) {
    case Judgement::kGood:
      return "good";
    case Judgement::kPoor:
      return "poor";
    case Judgement::kBad:
      return "bad";
    case Judgement::kNone:
      break;
  }
  return "plain";
}

Json FigureData(const std::optional<io::PlotPanel>& panel, const std::string& id) {
  if (!panel) return {};
  constexpr int kWidth = 560;  // [px]
  constexpr std::size_t kMostPoints = 6000;
  const double axes = std::round(kWidth / 2.0 * panel->height);
  Json legend = Json::array();
  for (const auto& [symbol, label] : io::LegendOf(*panel)) {
    legend.push_back({{"symbol", symbol}, {"label", label}});
  }
  return {{"id", id},
          {"width", kWidth},
          {"height", static_cast<int>(io::kAboveAxes + axes + io::kBelowAxes)},
          {"legend", std::move(legend)},
          {"elements", io::DrawPanel(*panel, kWidth, axes, kMostPoints)}};
}

Json VerdictData(std::string_view css_class, std::string_view word, std::string_view sentence) {
  return {{"class", css_class}, {"word", word}, {"sentence", sentence}};
}

Json LineData(std::string_view head, const std::vector<std::string>& cells,
              std::string_view css_class, std::string_view address) {
  Json line = {{"head", head}, {"class", css_class}, {"address", address}};
  for (const std::string& cell : cells) {
    // Letters break anywhere, numbers nowhere.
    const bool is_number = !cell.empty() && std::isdigit(static_cast<unsigned char>(cell[0])) != 0;
    line["cells"].push_back({{"text", cell}, {"class", is_number ? "number" : "words"}});
  }
  return line;
}

Json TableData(std::string_view caption, const std::vector<std::string>& names, Json lines) {
  if (lines.empty()) return nullptr;
  return {{"caption", caption}, {"names", names}, {"lines", std::move(lines)}};
}

Json ProvenanceData(const Provenance& provenance) {
  Json inputs = Json::array();
  for (const InputFile& input : provenance.inputs) {
    inputs.push_back(
        LineData(input.name, {input.sha256.value_or("not a regular file, read once")}));
  }
  Json options = Json::array();
  for (const auto& [name, value] : provenance.options) options.push_back(LineData(name, {value}));
  return {{"command", provenance.command},
          {"version", Version()},
          {"inputs", TableData("files read", {"file", "SHA-256 of its bytes"}, std::move(inputs))},
          {"options", TableData("options, including those of a configuration file",
                                {"option", "value"}, std::move(options))}};
}

}  // namespace mindahl::report
