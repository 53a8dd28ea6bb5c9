#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/drawing.h"
#include "report/html.h"
#include "report/json.h"
#include "report/statements.h"

namespace mindahl::report {

using io::PlotPanel;
using io::PlotSeries;
using io::PlotStyle;

namespace {

/// Names a record by its load where the records differ in it; "" of a record that is alone.
std::string LabelOf(const Report& report, std::size_t r) {
  if (report.records.size() == 1) return "";
  const auto& load = report.fit.records[r].normal_load;
  if (report.fit.is_load_series() && load) return Quantity(*load, "N", 3);
  return NameOf({&report.records[r].name, 1});
}

std::string LinesHtml(const std::vector<Line>& lines) {
  std::vector<TableLine> rows;
  for (const Line& line : lines) {
    if (line.label == "next" || line.label == "misfit") continue;  // they have places of their own
    rows.push_back({line.label, {line.text}, line.judgement});
  }
  return TableHtml("", {}, rows);
}

/// Returns the command that takes the next step.
std::string NextHtml(const Report& report, std::string_view command) {
  if (!report.next) return "";
  return SectionHtml("Next step",
                     fmt::format("{}<pre><code>{} {}</code></pre>\n",
                                 ParagraphHtml(NextStatement(*report.next) + ':'),
                                 io::HtmlText(command.empty() ? "mindahl fit FILE" : command),
                                 io::HtmlText(report.next->options)));
}

/// Returns friction (the slip force without a load), σ and α as bars with their intervals, and 1/3
/// as a mark of α; no bar of what has no value. One is green only of what may be quoted.
std::string IntervalsHtml(const Report& report) {
  constexpr double kLeft = 40.0;
  constexpr double kRight = 540.0;
  constexpr int kRow = 50;    // [px] of one bar
  constexpr int kLeast = 64;  // [px]: one bar alone is still to be seen on a telephone
  std::string svg;
  int middle = 31;
  const auto draw = [&](const char* symbol, const Shown& shown, std::string_view unit,
                        std::string_view judgement, std::optional<double> mark = {}) {
    if (!shown.is_estimate()) return;
    const double value = *shown.value;
    const std::optional<double>& lower = shown.lower;
    const std::optional<double>& upper = shown.upper;
    double least = std::min(lower.value_or(value), mark.value_or(value));
    double greatest = std::max(upper.value_or(value), mark.value_or(value));
    const double margin = greatest > least ? 0.25 * (greatest - least) : 0.1 * std::abs(value);
    least -= margin;
    greatest += margin;
    const auto x = [&](double at) {
      return kLeft + (kRight - kLeft) * (at - least) / (greatest - least);
    };
    const double left = lower ? x(*lower) : kLeft;
    const double right = std::max(upper ? x(*upper) : kRight, left + 2);
    svg += fmt::format(
        "<text x=\"8\" y=\"{}\">{}</text><text x=\"{:.0f}\" y=\"{}\">{}</text>"
        "<path class=\"grid\" d=\"M{:.0f} {}H{:.0f}\"/>"
        "<path class=\"interval {}\" d=\"M{:.1f} {}H{:.1f}v12H{:.1f}Z\"/>"
        "<path class=\"axis\" d=\"M{:.1f} {}v18\"/>",
        middle + 5, symbol, kLeft, middle - 17,
        io::HtmlText(QuantityWithInterval(value, lower, upper, unit)), kLeft, middle, kRight,
        judgement, left, middle - 6, right, left, x(value), middle - 9);
    if (mark) {
      svg += fmt::format(
          "<path class=\"mark\" d=\"M{:.1f} {}v24\"/><text x=\"{:.1f}\" y=\"{}\">1/3</text>",
          x(*mark), middle - 12, x(*mark) + 4, middle + 18);
    }
    middle += kRow;
  };
  const ParameterEstimate& slip_force = *report.fit.Find("slip_force");
  const ParameterEstimate& sigma = *report.fit.Find("sigma");
  const ParameterEstimate& alpha = *report.fit.Find("alpha");
  const ContactQuantity* friction = report.Find("friction_coefficient");
  if (friction != nullptr && friction->value) {
    draw("μ", {friction->value, friction->lower, friction->upper}, "-", JudgementOf(slip_force));
  } else {
    draw("Tc", WhatIsShown(slip_force), slip_force.unit, JudgementOf(slip_force));
  }
  draw("σ", WhatIsShown(sigma), sigma.unit, JudgementOf(sigma));
  draw("α", WhatIsShown(alpha), alpha.unit, JudgementOf(alpha),
       report.is_torsional() ? std::nullopt : std::optional(1.0 / 3));
  if (svg.empty()) return "";
  return FigureHtml(
      "intervals", fmt::format("Values with their {:.4g} % intervals", 100 * report.fit.confidence),
      "Green may be quoted; amber only with its interval.", std::max(middle - 31, kLeast), svg);
}

}  // namespace

io::Plot ToPlot(const Report& report) {
  RequireFitted(report, "a figure");
  PlotPanel measured = {.height = 1.2};
  PlotPanel residual = {.height = 0.45};
  const std::size_t records = report.records.size();
  std::vector<PlotSeries> lines;
  const auto add = [](std::vector<PlotSeries>& to, PlotSeries series) {
    if (!series.y.empty()) to.push_back(std::move(series));
  };
  for (std::size_t r = 0; r < records; ++r) {
    const loop::Record& record = report.records[r].record;
    const RecordFit& fit = report.fit.records[r];
    const std::vector<double>& x = record.displacement;
    const std::string label = LabelOf(report, r);
    // The first shade of a record that is alone is apart from the two lines that are fitted.
    const double shade =
        records == 1 ? 0.0 : static_cast<double>(r) / static_cast<double>(records - 1);
    add(measured.series,
        {label.empty() ? "measured" : label, x, record.force, PlotStyle::kPoints, shade});
    const bool is_force = fit.fitted_displacement.empty();
    add(lines, {r > 0 ? "" : "fitted", is_force ? x : fit.fitted_displacement, fit.fitted_force});
    add(residual.series, {"", x, fit.residual, PlotStyle::kPoints, shade});
    if (report.next && r < report.next->fitted_force.size()) {
      const std::string name = r > 0 ? "" : "fitted with " + report.next->options;
      add(lines, {name, x, report.next->fitted_force[r]});
    }
  }
  measured.series.insert(measured.series.end(), lines.begin(), lines.end());
  const Units& units = report.units;
  const bool is_torsional = report.is_torsional();
  const char* const along = is_torsional ? "angle" : "displacement";
  ScaleAxes(measured, along, units.displacement, is_torsional ? "torque" : "force", units.force);
  ScaleAxes(residual, along, units.displacement, "fitted − measured", units.response);
  measured.x_label.clear();  // the residual below has it
  return {.title = fmt::format("{}: {}", NameOf(report.files()), VerdictWord(report)),
          .panels = {std::move(measured), std::move(residual)}};
}

std::string ToPage(const Report& report, std::string_view command) {
  const std::string word(VerdictWord(report));
  const std::string title = fmt::format("{}: {}", NameOf(report.files()), word);
  if (report.failed()) {
    return PageHtml(title, VerdictHtml("bad", word, report.fit.solver.message), command);
  }
  const io::Plot figure = ToPlot(report);
  return PageHtml(
      title,
      fmt::format(
          "{}<div class=\"first\">\n<div>\n{}{}</div>\n<div>\n{}{}{}</div>\n</div>\n{}",
          VerdictHtml(JudgementOf(word), word, MisfitStatement(report)),
          FigureHtml("loop", "Measured and fitted loop", "Below it, what the fit leaves over.",
                     figure.panels[0]),
          FigureHtml("residual", "Residual",
                     "Fitted less measured over the same axis. A band without shape is noise.",
                     figure.panels[1]),
          IntervalsHtml(report), NextHtml(report, command),
          SectionHtml("Answer", LinesHtml(AnswerLines(report)) +
                                    TableHtml(fmt::format("models compared, rms in {}",
                                                          report.units.response),
                                              ComparedModels(report))),
          SectionHtml("Details, in SI units", LinesHtml(DetailLines(report)))),
      command);
}

}  // namespace mindahl::report
