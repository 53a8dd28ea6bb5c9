#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/io/plot.h"
#include "mindahl/report/page.h"
#include "report/fields.h"
#include "report/statements.h"

// Makes pages of HTML from the templates in src/report/templates, which are in the language of
// mustache(5) and part of the library.
//
// {{name}} in a template is a member of the data, shown as text: what is markup in it is escaped.
// {{#name}} … {{/name}} is shown where there is such a member, {{^name}} … {{/name}} where there is
// none: null, false and "" are none. A list is none where it is empty, else an object whose `rows`
// are its elements, so that what stands once around them goes with them. {{{name}}} is not escaped:
// drawings, and what the program itself writes into attributes.
namespace mindahl::report {

/// Returns a page, HTML 5, self-contained: it may load nothing, by a policy for the browser, and
/// has no script.
/// @param name  template of its body: "fit", "track" or "batch"
/// @param data  an object with every member that the template names, and `title`, plain text
/// @throws std::logic_error naming the template, for a member that the data do not have
std::string RenderPage(std::string_view name, const Json& data);

/// Returns "good", "poor", "bad" or "plain": its class of the page's style.
std::string_view CssClass(Judgement judgement);

/// Returns what drawing.html shows of a panel, null without one.
/// @param id  identifies the figure in its page, letters, digits, '_' and '-'
Json FigureData(const std::optional<io::PlotPanel>& panel, const std::string& id);

/// Returns what verdict.html shows.
Json VerdictData(std::string_view css_class, std::string_view word, std::string_view sentence);

/// Returns a line of table.html.
/// @param css_class  of its head
/// @param address    to which its head leads; "" none
Json LineData(std::string_view head, const std::vector<std::string>& cells,
              std::string_view css_class = "", std::string_view address = "");
/// Returns what table.html shows, null without lines.
/// @param names  of the columns, none for a table without
Json TableData(std::string_view caption, const std::vector<std::string>& names, Json lines);

/// Returns what provenance.html shows: what it takes to make the result again.
Json ProvenanceData(const Provenance& provenance);

}  // namespace mindahl::report
