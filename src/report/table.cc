#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <ranges>
#include <utility>

#include "core/text.h"
#include "mindahl/io/csv_table.h"
#include "report/html.h"
#include "report/json.h"
#include "report/statements.h"

namespace mindahl::report {

namespace {

struct Table {
  std::vector<std::string> names = {};  // of the columns: members that not every row has come last
  std::vector<std::vector<Json>> rows = {};
};

Table TableOf(const Json& rows) {
  Table table;
  for (const auto& [key, row] : rows.items()) {
    std::vector<std::string> names;
    std::vector<Json>& cells = table.rows.emplace_back();
    const auto add = [&](const std::string& name, const Json& cell) {
      names.push_back(name);
      cells.push_back(cell);
    };
    if (rows.is_object()) add("", key);
    for (const auto& [name, value] : row.items()) {
      if (!value.is_structured()) add(name, value);
      if (!value.is_object()) continue;
      for (const auto& [inner, cell] : value.items()) add(name + '\n' + inner, cell);
    }
    if (names.size() > table.names.size()) table.names = std::move(names);
  }
  return table;
}

std::string CellCsv(const Json& value) {
  if (value.is_null() || value == "") return "";
  return value.is_number() ? value.dump() : io::CsvCell(CellText(value));
}

}  // namespace

std::string CellText(const Json& value, int digits) {
  if (value.is_null()) return "-";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) {
    const bool is_exact = digits >= std::numeric_limits<double>::max_digits10;
    return is_exact ? fmt::format("{}", value.get<double>())
                    : fmt::format("{:.{}g}", value.get<double>(), digits);
  }
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string TableText(const Json& rows, int digits) {
  const Table table = TableOf(rows);
  if (table.rows.empty()) return "";
  std::vector<std::string> lines(table.rows.size() + 1);
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    std::vector<std::string> column = {table.names[c]};
    std::ranges::replace(column[0], '\n', ' ');
    bool is_right = false;
    for (const std::vector<Json>& cells : table.rows) {
      column.push_back(c < cells.size() ? CellText(cells[c], digits) : "");
      is_right = is_right || (c < cells.size() && cells[c].is_number());
    }
    const std::size_t width = CharactersIn(*std::ranges::max_element(column, {}, CharactersIn));
    for (std::size_t k = 0; k < lines.size(); ++k) {
      lines[k] += is_right ? fmt::format("  {:>{}}", column[k], width)
                           : fmt::format("  {:<{}}", column[k], width);
    }
  }
  std::string text;
  for (std::string& line : lines) {
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

std::string TableCsv(const Json& rows) {
  const Table table = TableOf(rows);
  std::string text = table.rows.empty() ? "" : fmt::format("{}\n", fmt::join(table.names, ","));
  for (const std::vector<Json>& cells : table.rows) {
    text += fmt::format("{}\n", fmt::join(cells | std::views::transform(CellCsv), ","));
  }
  return text;
}

std::string TableHtml(std::string_view caption, const Json& rows) {
  const Table table = TableOf(rows);
  std::vector<TableLine> lines;
  for (const std::vector<Json>& cells : table.rows) {
    TableLine& line = lines.emplace_back(CellText(cells.front()));
    for (const Json& cell : std::span(cells).subspan(1)) line.cells.push_back(CellText(cell));
  }
  return TableHtml(caption, table.names, lines);
}

std::string ResidualsCsv(const Report& report) {
  RequireFitted(report, "a table of residuals");
  const Units& units = report.units;
  const bool is_of_force = report.fit.response == loop::Channel::kForce;
  const auto names = std::to_array<std::string>(
      {"file", "time [s]", WithUnit("displacement", units.displacement),
       WithUnit("force", units.force),
       WithUnit(is_of_force ? "fitted_force" : "fitted_displacement", units.response),
       WithUnit("residual", units.response)});
  std::array<std::vector<double>, names.size()> cells;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const loop::Record& record = report.records[r].record;
    const RecordFit& fit = report.fit.records[r];
    const std::vector<double> number(record.size(), static_cast<double>(r + 1));
    auto* column = cells.begin();
    for (const std::vector<double>* values :
         {&number, &record.time, &record.displacement, &record.force,
          is_of_force ? &fit.fitted_force : &fit.fitted_displacement, &fit.residual}) {
      column->insert(column->end(), values->begin(), values->end());
      ++column;
    }
  }
  std::vector<io::CsvColumn> columns;
  for (std::size_t c = report.records.size() > 1 ? 0 : 1; c < names.size(); ++c) {
    const bool is_whole = cells.at(c).size() == cells.back().size();  // a record may have no time
    if (is_whole) columns.push_back({names.at(c), cells.at(c)});
  }
  return io::CsvText(columns);
}

}  // namespace mindahl::report
