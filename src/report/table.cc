#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "core/text.h"
#include "mindahl/io/csv_table.h"
#include "report/html.h"
#include "report/json.h"
#include "report/statements.h"

namespace mindahl::report {

namespace {

using Cells = std::vector<std::pair<std::string, Json>>;

std::vector<Cells> RowsOf(const Json& rows) {
  std::vector<Cells> all;
  for (const auto& [key, row] : rows.items()) {
    Cells& cells = all.emplace_back();
    if (rows.is_object()) cells.emplace_back("", key);
    for (const auto& [name, value] : row.items()) {
      if (value.is_array()) continue;
      if (!value.is_object()) {
        cells.emplace_back(name, value);
        continue;
      }
      for (const auto& [inner, cell] : value.items()) {
        cells.emplace_back(fmt::format("{}\n{}", name, inner), cell);
      }
    }
  }
  return all;
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
  const std::vector<Cells> all = RowsOf(rows);
  if (all.empty()) return "";
  // Members that not every row has come last.
  const Cells& longest = *std::ranges::max_element(all, {}, &Cells::size);
  std::vector<std::string> lines(all.size() + 1);
  for (std::size_t c = 0; c < longest.size(); ++c) {
    std::vector<std::string> column = {longest[c].first};
    std::ranges::replace(column[0], '\n', ' ');
    bool is_right = false;
    for (const Cells& cells : all) {
      column.push_back(c < cells.size() ? CellText(cells[c].second, digits) : "");
      is_right = is_right || (c < cells.size() && cells[c].second.is_number());
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
  std::string text;
  for (const Cells& cells : RowsOf(rows)) {
    std::vector<std::string> names;
    std::vector<std::string> line;
    for (const auto& [name, value] : cells) {
      names.push_back(name);
      line.push_back(CellCsv(value));
    }
    if (text.empty()) text += fmt::format("{}\n", fmt::join(names, ","));
    text += fmt::format("{}\n", fmt::join(line, ","));
  }
  return text;
}

std::string TableHtml(std::string_view caption, const Json& rows) {
  std::vector<std::string> names;
  std::vector<TableLine> lines;
  for (const Cells& cells : RowsOf(rows)) {
    std::vector<std::string> texts;
    for (const auto& [name, value] : cells) {
      if (lines.empty()) names.push_back(name);
      texts.push_back(CellText(value));
    }
    const std::string head = std::exchange(texts.front(), "");
    texts.erase(texts.begin());
    lines.push_back({head, std::move(texts)});
  }
  return TableHtml(caption, names, lines);
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
