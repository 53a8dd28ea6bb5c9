#include "mindahl/report/page.h"

#include <fmt/format.h>

#include <string>

#include "report/answer.h"
#include "report/fields.h"
#include "report/panels.h"
#include "report/template.h"

// Makes the data of templates/fit.html.
namespace mindahl::report {

namespace {

Json LinesData(std::string_view caption, const std::vector<Line>& lines) {
  Json rows = Json::array();
  for (const Line& line : lines) {
    if (line.label == "next" || line.label == "misfit") continue;  // they have places of their own
    rows.push_back(LineData(line.label, {line.text}, CssClass(line.judgement)));
  }
  return TableData(caption, {}, std::move(rows));
}

/// Returns the command that takes the next step.
Json NextData(const Report& report, const Provenance& provenance) {
  if (!report.next) return nullptr;
  const std::string command = provenance.command.empty() ? "mindahl fit FILE" : provenance.command;
  return {{"text", NextStatement(report, *report.next) + ':'},
          {"command", fmt::format("{} {}", command, report.next->options)}};
}

Json MeasuredData(const Report& report) {
  Json rows = Json::array();
  for (const char* section : {"measured.", "input."}) {
    for (const auto& [name, value] : ValuesUnder(report, section)) {
      rows.push_back(LineData(name, {value}));
    }
  }
  return TableData("of the record, without a model", {}, std::move(rows));
}

}  // namespace

std::string ToPage(const Report& report, const Provenance& provenance) {
  const std::string word(VerdictWord(report));
  Json data = {{"title", fmt::format("{}: {}", NameOf(report.files), word)},
               {"fitted", nullptr},
               {"provenance", ProvenanceData(provenance)}};
  if (report.failed()) {
    data["verdict"] = VerdictData("bad", word, report.fit.solver.message);
    return RenderPage("fit", data);
  }
  data["verdict"] = VerdictData(CssClass(JudgementOf(word)), word, MisfitStatement(report));
  const LoopPanels panels = DrawLoop(report);
  data["fitted"] = {{"answer", LinesData("", AnswerLines(report))},
                    {"intervals", DrawIntervals(report)},
                    {"confidence", fmt::format("{:.4g} %", 100 * report.fit.confidence)},
                    {"next", NextData(report, provenance)},
                    {"loop", FigureData(panels.loop, "loop")},
                    {"residual", FigureData(panels.residual, "residual")},
                    {"details", LinesData("of the fit", DetailLines(report))},
                    {"measured", MeasuredData(report)}};
  return RenderPage("fit", data);
}

}  // namespace mindahl::report
