#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "mindahl/io/csv_table.h"
#include "mindahl/report/report.h"
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
  return NameOf({&report.files[r], 1});
}

bool IsUnderLoad(const Report& report, const loop::Record& record, std::size_t sample) {
  const auto& window = report.options.preparation.load_window;
  if (!window || record.normal_load.empty()) return true;
  const double load = record.normal_load[sample];
  return load >= window->lower && load <= window->upper;
}

constexpr double kMeasuredShade = 0.0;  // apart from the two lines that are fitted
constexpr std::size_t kMostNamed = 8;   // a legend of many files would be longer than the page

/// Returns where the last cycle of a record begins that is too long for all of its fit to be drawn:
/// a line through some of its samples would cut corners.
std::size_t FirstDrawn(const identification::RecordFit& fit) {
  constexpr std::size_t kMostSamples = 2000;
  const auto& reversals = fit.reversals;
  const bool is_long = fit.fitted_force.size() > kMostSamples && reversals.size() >= 4;
  return is_long ? reversals[reversals.size() - 4] : 0;
}

}  // namespace

io::Plot ToPlot(const Report& report) {
  RequireFitted(report, "a figure");
  PlotPanel measured = {.height = 1.2};
  PlotPanel residual = {.height = 0.45};
  const std::size_t records = report.records.size();
  std::vector<PlotSeries> lines;
  for (std::size_t r = 0; r < records; ++r) {
    const loop::Record& record = report.records[r].record;
    const identification::RecordFit& fit = report.fit.records[r];
    const std::string label = LabelOf(report, r);
    const bool is_named = records <= kMostNamed || r == 0 || r + 1 == records;
    const auto add = [&](std::vector<PlotSeries>& to, std::string name, PlotStyle style,
                         const std::vector<double>& x, const std::vector<double>& y,
                         std::optional<double> shade, std::size_t first = 0) {
      PlotSeries series{.label = std::move(name), .style = style, .shade = shade};
      for (std::size_t i = first; i < std::min(x.size(), y.size()); ++i) {
        if (!IsUnderLoad(report, record, i)) continue;
        series.x.push_back(x[i]);
        series.y.push_back(y[i]);
      }
      if (!series.x.empty()) to.push_back(std::move(series));
    };
    const std::optional<double> shade =
        records == 1 ? kMeasuredShade : static_cast<double>(r) / static_cast<double>(records - 1);
    add(measured.series,
        !is_named       ? ""
        : label.empty() ? "measured"
                        : label,
        PlotStyle::kPoints, record.displacement, record.force, shade);
    const std::vector<double>& along_fit =
        fit.fitted_displacement.empty() ? record.displacement : fit.fitted_displacement;
    const std::size_t first = FirstDrawn(fit);
    add(lines,
        r > 0       ? ""
        : first > 0 ? "fitted, last cycle"
                    : "fitted",
        PlotStyle::kLine, along_fit, fit.fitted_force, std::nullopt, first);
    add(residual.series, "", PlotStyle::kPoints, record.displacement, fit.residual, shade);
    if (report.next && r < report.next->fitted_force.size()) {
      add(lines, r > 0 ? "" : "fitted with " + report.next->options, PlotStyle::kLine,
          record.displacement, report.next->fitted_force[r], std::nullopt, first);
    }
  }
  measured.series.insert(measured.series.end(), lines.begin(), lines.end());
  const Units& units = report.units;
  const bool is_torsional = report.is_torsional();
  const char* const along = is_torsional ? "angle" : "displacement";
  ScaleAxes(measured, along, units.displacement, is_torsional ? "torque" : "force", units.force);
  ScaleAxes(residual, along, units.displacement, "fitted − measured", units.response);
  measured.x_label.clear();  // the residual below has it
  return {.title = fmt::format("{}: {}", NameOf(report.files), VerdictWord(report)),
          .panels = {std::move(measured), std::move(residual)}};
}

std::string ResidualsCsv(const Report& report) {
  RequireFitted(report, "a table of residuals");
  const bool is_of_force = report.fit.response == loop::Channel::kForce;
  const bool is_timed = std::ranges::none_of(
      report.records, [](const io::RecordFile& input) { return input.record.time.empty(); });
  constexpr std::size_t kColumns = 6;
  const std::array<std::string, kColumns> names = {
      "file",
      "time [s]",
      WithUnit("displacement", report.units.displacement),
      WithUnit("force", report.units.force),
      WithUnit(is_of_force ? "fitted_force" : "fitted_displacement", report.units.response),
      WithUnit("residual", report.units.response)};
  std::array<std::vector<double>, kColumns> cells;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const loop::Record& record = report.records[r].record;
    const identification::RecordFit& fit = report.fit.records[r];
    cells[0].insert(cells[0].end(), record.size(), static_cast<double>(r + 1));
    std::size_t column = 1;
    for (const std::vector<double>* values :
         {&record.time, &record.displacement, &record.force,
          is_of_force ? &fit.fitted_force : &fit.fitted_displacement, &fit.residual}) {
      cells.at(column).insert(cells.at(column).end(), values->begin(), values->end());
      ++column;
    }
  }
  std::vector<io::CsvColumn> columns;
  for (std::size_t k = 0; k < kColumns; ++k) {
    const bool is_needed = k == 0 ? report.records.size() > 1 : k != 1 || is_timed;
    if (is_needed) columns.push_back({names.at(k), cells.at(k)});
  }
  return io::CsvText(columns);
}

}  // namespace mindahl::report
