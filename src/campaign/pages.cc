#include "mindahl/campaign/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "io/html.h"
#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/test_summary.h"
#include "mindahl/report/units.h"
#include "report/page_parts.h"
#include "report/statements.h"

namespace mindahl::campaign {

using identification::ParameterEstimate;
using report::Cell;
using report::CssClass;
using report::Heading;
using report::Number;
using report::Paragraph;
using report::Quantity;
using report::QuantityWithError;
using report::SentenceList;
using report::Shown;
using report::Table;
using report::Words;

namespace {

constexpr const char* kNone = "–";
constexpr std::array<std::string_view, 3> kParameters = {"sigma", "alpha", "slip_force"};

std::string Header(const std::string& title) {
  return fmt::format("<header><h1>{}</h1></header>\n<main>\n", io::HtmlText(title));
}

/// No number of what is not known.
Cell ParameterCell(const std::vector<ParameterEstimate>& parameters, std::string_view name) {
  const auto found = std::ranges::find(parameters, name, &ParameterEstimate::name);
  if (found == parameters.end()) return Number(kNone);
  const ParameterEstimate& estimate = *found;
  switch (report::WhatIsShown(estimate)) {
    case Shown::kValue:
      return Number(QuantityWithError(estimate.value, estimate.standard_error, estimate.unit));
    case Shown::kHeld:
      return Number(Quantity(estimate.value, estimate.unit) + ", held");
    case Shown::kLowerLimit:
      if (estimate.lower95) return Number("> " + Quantity(*estimate.lower95, estimate.unit));
      break;
    case Shown::kNothing:
      break;
  }
  return Number(kNone);
}

/// A parameter of every file that identifies it, with its interval, over the file's place.
std::optional<io::PlotPanel> QuantityPanel(std::span<const FileResult> files,
                                           std::string_view name) {
  io::PlotSeries series{"interval", {}, {}, io::PlotStyle::kIntervals};
  series.shade = 0.3;
  std::string_view unit;
  double largest = 0.0;
  for (std::size_t k = 0; k < files.size(); ++k) {
    const auto& parameters = files[k].parameters;
    const auto found = std::ranges::find(parameters, name, &ParameterEstimate::name);
    if (found == parameters.end()) continue;
    const ParameterEstimate& estimate = *found;
    if (report::WhatIsShown(estimate) != Shown::kValue) continue;
    if (!estimate.lower95 || !estimate.upper95) continue;
    series.x.push_back(static_cast<double>(k + 1));
    series.y.push_back(estimate.value);
    series.lower.push_back(*estimate.lower95);
    series.upper.push_back(*estimate.upper95);
    unit = estimate.unit;
    largest = std::max(largest, std::abs(estimate.value));
  }
  if (series.x.size() < 2) return std::nullopt;
  const report::ScaledUnit prefixed = report::UnitFor(unit, largest);
  for (auto* values : {&series.y, &series.lower, &series.upper}) {
    for (double& value : *values) value /= prefixed.factor;
  }
  return io::PlotPanel{.x_label = "file",
                       .y_label = report::WithUnit(name, prefixed.name),
                       .series = {std::move(series)}};
}

/// An address within a page: whatever is no letter, digit, '-', '_' or '.' in hexadecimal.
std::string Address(std::string_view name) {
  std::string address;
  for (const char character : name) {
    const auto byte = static_cast<unsigned char>(character);
    const bool is_plain = (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') ||
                          (byte >= '0' && byte <= '9') || character == '-' || character == '_' ||
                          character == '.';
    address += is_plain ? std::string(1, character) : fmt::format("%{:02X}", byte);
  }
  return address;
}

}  // namespace

std::string ToPage(const TestSummary& test, const report::Provenance& provenance) {
  const std::string title = fmt::format("{}: {} cycles", report::NameOf(test.files), test.cycles);
  std::string body = Header(title);
  const bool is_failed = std::ranges::any_of(test.flags, [&](const FlagCount& flag) {
    return flag.name == "not_converged" && flag.cycles == test.fits;
  });
  if (is_failed) {
    body += report::VerdictBlock("bad", "failed", "no fit of a cycle converged");
  } else if (test.changes.empty()) {
    body += report::VerdictBlock("good", "steady", std::string(kNothingChanged));
  } else {
    body += report::VerdictBlock("poor", "changed", "these changes are beyond chance");
    body += SentenceList(test.changes);
  }
  body += Heading("Over the test");
  body +=
      Paragraph(fmt::format("{} cycles of {} samples, {} fits; {} dissipated in all{}; {} samples "
                            "at the ends belong to no whole cycle.",
                            test.cycles, test.samples, test.fits, Quantity(test.dissipated, "J"),
                            InWords(test.energy_counts), test.unused_samples));
  if (test.shared_alpha) body += Paragraph(SharedAlphaInWords(*test.shared_alpha) + ".");
  Table courses("ends of the segments of each time history", {"quantity", "at first", "at last"});
  for (const Evolution& evolution : test.evolutions) {
    const auto& stretches = evolution.description.stretches;
    if (stretches.empty()) continue;
    courses.Row(evolution.name, {Number(Quantity(stretches.front().at_start, evolution.unit)),
                                 Number(Quantity(stretches.back().at_end, evolution.unit))});
  }
  body += courses.Html();

  const std::vector<io::PlotPanel> panels = EvolutionPanels(test.evolutions);
  if (!panels.empty()) {
    body += Heading("Evolution") + "<div class=\"figures\">\n";
    for (std::size_t k = 0; k < panels.size(); ++k) {
      body += io::HtmlFigure(
          panels[k],
          {.id = fmt::format("evolution-{}", k + 1),
           .title = panels[k].y_label,
           .description = "Dashed lines are changes beyond chance, each at its first cycle."});
    }
    body += "</div>\n";
  }

  body += Heading("What to mind");
  Table flags("cycles with a flag", {"flag", "cycles", "what it says"});
  for (const FlagCount& flag : test.flags) {
    flags.Row(flag.name, {Number(std::to_string(flag.cycles)), Words(flag.meaning)});
  }
  body += flags.empty() ? Paragraph("No cycle has a flag.") : flags.Html();
  body +=
      Paragraph("Errors assume that the model is adequate: check some cycles with mindahl fit.");
  body += report::ReproduceSection(provenance) + "</main>\n";
  return io::HtmlPage(title, body);
}

std::string BatchIndexPage(std::span<const FileResult> files,
                           std::span<const RepeatedQuantity> repeated,
                           const report::Provenance& provenance) {
  const auto done =
      std::ranges::count_if(files, [](const FileResult& file) { return file.fault.empty(); });
  const std::string title = fmt::format("{} of {} files fitted", done, files.size());
  std::string body = Header(title) + Heading("Files");
  body +=
      "<div class=\"table\"><table><caption>one fit a file; only identified quantities have a "
      "number</caption>\n"
      "<thead><tr>";
  for (const char* column :
       {"", "file", "verdict", "sigma", "alpha", "slip_force", "why not done"}) {
    body += fmt::format("<th scope=\"col\">{}</th>", *column == '\0' ? "number" : column);
  }
  body += "</tr></thead>\n<tbody>\n";
  for (std::size_t k = 0; k < files.size(); ++k) {
    const FileResult& file = files[k];
    const std::string name = io::HtmlText(file.file);
    body += fmt::format(
        "<tr><td class=\"number\">{}</td><th scope=\"row\">{}</th>", k + 1,
        file.page.empty() ? name : fmt::format("<a href=\"{}\">{}</a>", Address(file.page), name));
    body += fmt::format("<td class=\"{}\">{}</td>",
                        file.verdict.empty() ? "" : CssClass(report::JudgementOf(file.verdict)),
                        io::HtmlText(file.verdict.empty() ? kNone : file.verdict));
    for (const std::string_view parameter : kParameters) {
      body += fmt::format("<td class=\"number\">{}</td>",
                          io::HtmlText(ParameterCell(file.parameters, parameter).text));
    }
    body += fmt::format("<td class=\"words\">{}</td></tr>\n", io::HtmlText(file.fault));
  }
  body += "</tbody></table></div>\n";

  Table scatter("over the fitted files in which the quantity is known",
                {"quantity", "files", "mean", "its error", "scatter between files", "by noise",
                 "common to all", ""});
  for (const RepeatedQuantity& quantity : repeated) {
    const Repeats& repeats = quantity.repeats;
    const report::ScaledUnit unit = report::UnitFor(quantity.unit, repeats.mean);
    const auto cell = [&](double value) {
      return Number(
          fmt::format("{:.3g}{}{}", value / unit.factor, unit.name.empty() ? "" : " ", unit.name));
    };
    scatter.Row(
        quantity.name,
        {Number(std::to_string(repeats.count)), Number(Quantity(repeats.mean, quantity.unit)),
         cell(repeats.mean_error()), cell(repeats.standard_deviation),
         repeats.stated_error ? cell(*repeats.stated_error) : Number(kNone),
         repeats.common_error ? cell(*repeats.common_error) : Number(kNone),
         Words(repeats.InWords(), repeats.exceed_errors() ? "poor" : "good")});
  }
  if (!scatter.empty()) body += Heading("If these are repeats") + scatter.Html();
  std::string figures;
  for (const std::string_view parameter : kParameters) {
    if (const auto panel = QuantityPanel(files, parameter)) {
      figures += io::HtmlFigure(*panel, {.id = fmt::format("files-{}", parameter),
                                         .title = std::string(parameter),
                                         .description = "One point for each file that identifies "
                                                        "it, by its number in the table."});
    }
  }
  if (!figures.empty()) {
    body += Heading("From file to file") + "<div class=\"figures\">\n" + figures + "</div>\n";
  }
  body += report::ReproduceSection(provenance) + "</main>\n";
  return io::HtmlPage(title, body);
}

}  // namespace mindahl::campaign
