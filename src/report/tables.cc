#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "mindahl/io/csv_table.h"
#include "mindahl/report/report.h"
#include "mindahl/report/units.h"
#include "report/names.h"
#include "report/statements.h"

namespace mindahl::report {

std::string ResidualsCsv(const Report& report) {
  RequireFitted(report, "a table of residuals");
  std::vector<double> file;
  std::vector<double> time;
  std::vector<double> displacement;
  std::vector<double> force;
  const bool is_of_force = report.fit.response == loop::Channel::kForce;
  std::vector<double> fitted;
  std::vector<double> residual;
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const loop::Record& record = report.records[r].record;
    file.insert(file.end(), record.size(), static_cast<double>(r + 1));
    append(time, record.time);
    append(displacement, record.displacement);
    append(force, record.force);
    const identification::RecordFit& fit = report.fit.records[r];
    append(fitted, is_of_force ? fit.fitted_force : fit.fitted_displacement);
    append(residual, report.fit.records[r].residual);
  }
  const bool timed = std::ranges::none_of(
      report.records, [](const io::RecordFile& input) { return input.record.time.empty(); });
  std::vector<io::CsvColumn> columns;
  if (report.records.size() > 1) columns.push_back({"file", file});
  if (timed) columns.push_back({"time [s]", time});
  columns.push_back({WithUnit("displacement", report.units.displacement), displacement});
  columns.push_back({WithUnit("force", report.units.force), force});
  columns.push_back(
      {WithUnit(is_of_force ? "fitted_force" : "fitted_displacement", report.units.response),
       fitted});
  columns.push_back({WithUnit("residual", report.units.response), residual});
  return io::CsvText(columns);
}

}  // namespace mindahl::report
