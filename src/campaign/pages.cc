#include "mindahl/campaign/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/test_summary.h"
#include "mindahl/report/units.h"
#include "report/statements.h"
#include "report/template.h"

namespace mindahl::campaign {

using identification::ParameterEstimate;
using report::CssClass;
using report::FigureData;
using report::Json;
using report::JudgementOf;
using report::Quantity;
using report::QuantityWithError;
using report::Shown;
using report::VerdictData;

namespace {

const std::string kNone = "–";
constexpr std::array<std::string_view, 3> kParameters = {"sigma", "alpha", "slip_force"};

/// Returns no number of what is not known.
std::string ParameterText(const std::vector<ParameterEstimate>& parameters, std::string_view name) {
  const auto found = std::ranges::find(parameters, name, &ParameterEstimate::name);
  if (found == parameters.end()) return kNone;
  const ParameterEstimate& estimate = *found;
  switch (report::WhatIsShown(estimate)) {
    case Shown::kValue:
      return QuantityWithError(estimate.value, estimate.standard_error, estimate.unit);
    case Shown::kHeld:
      return Quantity(estimate.value, estimate.unit) + ", held";
    case Shown::kLowerLimit:
      if (estimate.lower95) return "> " + Quantity(*estimate.lower95, estimate.unit);
      break;
    case Shown::kNothing:
      break;
  }
  return kNone;
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
  const bool is_failed = std::ranges::any_of(test.flags, [&](const FlagCount& flag) {
    return flag.name == "not_converged" && flag.cycles == test.fits;
  });
  Json ends = Json::array();
  for (const Evolution& evolution : test.evolutions) {
    const auto& stretches = evolution.description.stretches;
    if (stretches.empty()) continue;
    ends.push_back({{"name", evolution.name},
                    {"first", Quantity(stretches.front().at_start, evolution.unit)},
                    {"last", Quantity(stretches.back().at_end, evolution.unit)}});
  }
  Json evolutions = Json::array();
  for (io::PlotPanel& panel : EvolutionPanels(test.evolutions)) {
    const std::string id = fmt::format("evolution-{}", evolutions.size() + 1);
    std::string quantity = panel.y_label;
    evolutions.push_back({{"id", id},
                          {"quantity", std::move(quantity)},
                          {"figure", FigureData(std::move(panel), id)}});
  }
  Json flags = Json::array();
  for (const FlagCount& flag : test.flags) {
    flags.push_back({{"name", flag.name}, {"cycles", flag.cycles}, {"meaning", flag.meaning}});
  }
  return report::RenderPage(
      "track",
      {{"title", fmt::format("{}: {} cycles", report::NameOf(test.files), test.cycles)},
       {"verdict", is_failed ? VerdictData("bad", "failed", "no fit of a cycle converged")
                   : test.changes.empty()
                       ? VerdictData("good", "steady", kNothingChanged)
                       : VerdictData("poor", "changed", "these changes are beyond chance")},
       {"changes", is_failed ? Json() : Json(test.changes)},
       {"cycles", test.cycles},
       {"samples", test.samples},
       {"fits", test.fits},
       {"dissipated", Quantity(test.dissipated, "J")},
       {"energy_counts", InWords(test.energy_counts)},
       {"unused_samples", test.unused_samples},
       {"shared_alpha", test.shared_alpha ? SharedAlphaInWords(*test.shared_alpha) : ""},
       {"ends", std::move(ends)},
       {"evolutions", std::move(evolutions)},
       {"flags", std::move(flags)},
       {"provenance", report::ProvenanceData(provenance)}});
}

std::string BatchIndexPage(std::span<const FileResult> files,
                           std::span<const RepeatedQuantity> repeated,
                           const report::Provenance& provenance) {
  const auto done =
      std::ranges::count_if(files, [](const FileResult& file) { return file.fault.empty(); });
  Json file_rows = Json::array();
  for (const FileResult& file : files) {
    Json row = {{"number", file_rows.size() + 1},
                {"file", file.file},
                {"address", Address(file.page)},
                {"verdict", file.verdict},
                {"class", file.verdict.empty() ? "" : CssClass(JudgementOf(file.verdict))},
                {"fault", file.fault}};
    for (const std::string_view parameter : kParameters) {
      row[parameter] = ParameterText(file.parameters, parameter);
    }
    file_rows.push_back(std::move(row));
  }
  Json repeats = Json::array();
  for (const RepeatedQuantity& quantity : repeated) {
    const Repeats& found = quantity.repeats;
    const report::ScaledUnit unit = report::UnitFor(quantity.unit, found.mean);
    const auto text = [&](std::optional<double> value) {
      if (!value) return kNone;
      return fmt::format("{:.3g}{}{}", *value / unit.factor, unit.name.empty() ? "" : " ",
                         unit.name);
    };
    repeats.push_back({{"name", quantity.name},
                       {"count", found.count},
                       {"mean", Quantity(found.mean, quantity.unit)},
                       {"mean_error", text(found.mean_error())},
                       {"scatter", text(found.standard_deviation)},
                       {"stated_error", text(found.stated_error)},
                       {"common_error", text(found.common_error)},
                       {"conclusion", found.InWords()},
                       {"class", found.exceed_errors() ? "poor" : "good"}});
  }
  Json quantities = Json::array();
  for (const std::string_view parameter : kParameters) {
    const std::string id = fmt::format("files-{}", parameter);
    if (const auto panel = QuantityPanel(files, parameter)) {
      quantities.push_back(
          {{"id", id}, {"quantity", parameter}, {"figure", FigureData(panel, id)}});
    }
  }
  return report::RenderPage("batch",
                            {{"title", fmt::format("{} of {} files fitted", done, files.size())},
                             {"files", std::move(file_rows)},
                             {"repeats", std::move(repeats)},
                             {"quantities", std::move(quantities)},
                             {"provenance", report::ProvenanceData(provenance)}});
}

}  // namespace mindahl::campaign
