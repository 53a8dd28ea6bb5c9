#include "mindahl/io/record_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "core/text.h"
#include "io/record_builder.h"
#include "io/roles.h"
#include "mindahl/core/error.h"
#include "mindahl/core/units.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool IsNumber(double value) { return !std::isnan(value); }

/// Keeps some rows of a table's column.
std::vector<double> AtRows(std::span<const double> values, const std::vector<std::size_t>& rows) {
  std::vector<double> kept;
  if (values.empty()) return kept;
  kept.reserve(rows.size());
  for (const std::size_t row : rows) kept.push_back(values[row]);
  return kept;
}

/// Reads the columns chosen in addition to displacement and force, then some of the others: those
/// with a number in every row, and not the same in all.
void AddCovariates(const ColumnNames& names, const std::vector<std::string>& choices,
                   const std::vector<std::size_t>& rows, RecordFile& file) {
  const CsvTable& table = names.table();
  const RoleRules& rules = RulesOf(Role::kOther);
  const auto add = [&](std::size_t column, const std::string& name, std::vector<double> values) {
    const std::string unit = names.UnitOf(column, "");
    file.covariates.push_back({.name = name, .index = column + 1, .unit = unit});
    file.record.covariates.push_back({.name = name, .unit = unit, .values = std::move(values)});
  };
  const auto is_read = [&](std::size_t column) {
    return std::ranges::find(file.covariates, column + 1, &ChosenColumn::index) !=
           file.covariates.end();
  };
  for (const std::string& choice : choices) {
    const std::size_t column = names.Chosen(choice, rules);
    const bool is_displacement = column + 1 == file.displacement.index;
    if (is_displacement || column + 1 == file.force.index) {
      throw InputError(fmt::format("{}: {} is the {} already: choose another column for the {}",
                                   table.file, names.Label(column),
                                   is_displacement ? "displacement" : "force", rules.name));
    }
    if (is_read(column)) {
      throw InputError(fmt::format("{}: {} is chosen twice as a {}: choose it once", table.file,
                                   names.Label(column), rules.name));
    }
    std::vector<double> values = AtRows(table.columns[column].values, rows);
    if (values.empty() || !std::ranges::all_of(values, IsNumber)) {
      static_cast<void>(table.Numbers(column));  // throws
    }
    add(column, choice, std::move(values));
  }
  std::size_t left = kMostOtherColumns;
  for (std::size_t column = 0; column < table.columns.size() && left > 0; ++column) {
    const bool has_role = column + 1 == file.displacement.index || column + 1 == file.force.index ||
                          (file.time && column + 1 == file.time->index) ||
                          (file.normal_load && column + 1 == file.normal_load->index);
    if (has_role || is_read(column) || !names.StatesOneUnit(column)) continue;
    if (table.columns[column].values.empty() || table.columns[column].is_clock) continue;
    std::vector<double> values = AtRows(table.columns[column].values, rows);
    const bool changes = std::ranges::adjacent_find(values, std::not_equal_to<>()) != values.end();
    if (!changes || !std::ranges::all_of(values, IsNumber)) continue;
    add(column, names.NameOf(column), std::move(values));
    --left;
  }
}

/// The time of a table, by which another is joined to it; empty where it has none.
std::vector<double> TimesOf(const CsvTable& table, const std::string& given) {
  const ColumnNames names(table);
  const std::vector<bool> taken(table.columns.size());
  Expression time = given.empty() ? Expression{} : names.Read(given, RulesOf(Role::kTime));
  if (time.terms.empty()) {
    const std::optional<std::size_t> column = FindColumnOf(names, Role::kTime, taken);
    if (!column) return {};
    time.terms = {{*column, 1.0}};
  }
  const std::size_t column = time.terms.front().column;
  std::vector<std::string> notes;
  const Unit unit = table.columns[column].is_clock
                        ? Unit{.symbol = "s"}
                        : FindUnit(names, RulesOf(Role::kTime), time, notes);
  std::vector<double> times(table.columns[column].values);
  for (double& value : times) value = unit.ToSi(value);
  return times;
}

/// Appends the columns of another file of the same test: at the times of the first, by straight
/// lines, where both have a time, else row by row.
void AddColumnsOf(CsvTable& table, const CsvTable& other, const std::string& given_time) {
  const std::vector<double> times = TimesOf(table, given_time);
  const std::vector<double> of_other = TimesOf(other, "");
  const bool by_time = !times.empty() && !of_other.empty() && std::ranges::is_sorted(of_other) &&
                       std::ranges::all_of(of_other, IsNumber);
  if (!by_time && table.rows() != other.rows()) {
    throw InputError(fmt::format(
        "--with: {} has {} rows and {} {}, and not both a time: give files of as many rows",
        table.file, table.rows(), other.file, other.rows()));
  }
  for (const TableColumn& column : other.columns) {
    TableColumn& added = table.columns.emplace_back(column);
    if (!by_time || added.values.empty()) continue;
    added.values.assign(table.rows(), kNone);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const auto above = std::ranges::lower_bound(of_other, times[row]);
      if (above == of_other.end() || !(of_other.front() <= times[row])) continue;
      const auto k = static_cast<std::size_t>(above - of_other.begin());
      const double step = k == 0 ? 0.0 : of_other[k] - of_other[k - 1];
      const double weight = step > 0 ? (of_other[k] - times[row]) / step : 0.0;
      added.values[row] = weight > 0
                              ? weight * column.values[k - 1] + (1 - weight) * column.values[k]
                              : column.values[k];
    }
    // Times of the first file that the other does not cover are no fault.
    const auto hole = std::ranges::find_if_not(added.values, IsNumber);
    if (hole == added.values.end()) continue;
    const auto row = static_cast<std::size_t>(hole - added.values.begin());
    added.missing =
        fmt::format("{}:{}: {} has no row at this time", table.file, table.lines[row], other.file);
  }
  table.notes.insert(table.notes.end(), other.notes.begin(), other.notes.end());
  table.notes.push_back(fmt::format("{}: its columns follow those of {}, {}", other.file,
                                    table.file, by_time ? "at its times" : "row by row"));
  table.header_line = std::max<std::size_t>(table.header_line, 1);
}

/// One column of a path: that chosen, the one that is recognised, or the first. Taking SI for
/// granted is the documented default here.
std::vector<double> ReadPathColumn(const CsvTable& table, Role role, const std::string& text) {
  const ColumnNames names(table);
  const std::vector<bool> taken(table.columns.size());
  Expression columns = names.Read(text, RulesOf(role));
  if (columns.terms.empty()) {
    columns.terms = {{FindColumnOf(names, role, taken).value_or(0), 1.0}};
  }
  const Dimension dimension = columns.unit.empty() ? names.DimensionOf(columns.terms.front().column)
                                                   : DimensionOfUnit(columns.unit);
  const bool is_torsional = dimension == Dimension::kAngle || dimension == Dimension::kTorque;
  const bool may_be = role != Role::kForce;
  std::vector<std::string> notes;
  const RoleRules& rules = RulesOf(role, is_torsional && may_be);
  const Unit unit = FindUnit(names, rules, columns, notes);
  std::vector<double> values(table.rows(), columns.offset);
  for (const Expression::Term& term : columns.terms) {
    const std::span<const double> numbers = table.Numbers(term.column);
    for (std::size_t row = 0; row < values.size(); ++row) values[row] += term.weight * numbers[row];
  }
  for (std::size_t row = 0; row < values.size(); ++row) {
    const double value = std::exchange(values[row], unit.ToSi(values[row]));
    if (std::isfinite(values[row])) continue;
    throw InputError(fmt::format(
        "{}:{}:{}: {} = {} {} is too large: must be below 1.8e308 in SI units", table.file,
        table.lines[row], columns.terms.front().column + 1, rules.name, value, unit.symbol));
  }
  return values;
}

}  // namespace

RecordFile RecordOf(const CsvTable& table, const RecordColumns& columns) {
  RecordBuilder builder(table, columns);
  const std::vector<std::size_t>& wanted = builder.wanted();
  std::string fault;
  std::size_t fault_row = table.rows();
  for (const std::size_t column : wanted) {
    const TableColumn& of = table.columns[column];
    if (of.values.empty()) static_cast<void>(table.Numbers(column));  // throws
    if (of.fault.empty() || of.fault_row >= fault_row) continue;
    fault = of.fault;
    fault_row = of.fault_row;
  }
  if (!fault.empty() && !columns.skip_broken_rows) throw InputError(fault);

  RecordFile& file = builder.file();
  std::vector<double> cells(wanted.size());
  std::vector<std::size_t> rows;
  rows.reserve(table.rows());
  MissingRows missing;
  RowValues values{};
  auto block = table.blocks.begin();
  bool begins_block = false;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (block != table.blocks.end() && row == *block) {
      begins_block = true;
      ++block;
    }
    const std::string* first_missing = nullptr;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      cells[k] = table.columns[wanted[k]].values[row];
      if (IsNumber(cells[k]) || first_missing != nullptr) continue;
      const TableColumn& of = table.columns[wanted[k]];
      first_missing = of.missing.empty() ? &of.fault : &of.missing;
    }
    if (first_missing != nullptr) {
      missing.Count(table.lines[row], *first_missing);
      continue;
    }
    const std::string broken = builder.Convert(cells, table.lines[row], row, begins_block, values);
    if (!broken.empty()) {
      if (!columns.skip_broken_rows) throw InputError(broken);
      missing.Count(table.lines[row], broken);
      continue;
    }
    begins_block = false;
    builder.Append(values, file.record);
    file.lines.push_back(table.lines[row]);
    rows.push_back(row);
  }
  if (!columns.skip_broken_rows) missing.RequireFew(table.rows());
  if (rows.empty()) throw InputError(missing.first);
  file.left_out = missing.rows;
  if (missing.rows.count > 0) {
    file.notes.push_back(fmt::format(
        "{}: {} of {} rows have no number in a column that is used and are left out, the first in "
        "line {}",
        table.file, missing.rows.count, table.rows(), missing.rows.first_line));
  }
  AddCovariates(ColumnNames(table), columns.covariates, rows, file);
  return std::move(file);
}

RecordFile ReadRecord(const std::filesystem::path& path, const RecordColumns& columns,
                      const ReadLimits& limits) {
  CsvTable table = ReadCsvTable(path, limits, columns.encoding, columns.skip_broken_rows);
  if (!columns.with.empty()) {
    AddColumnsOf(table, ReadCsvTable(columns.with, limits, columns.encoding), columns.time);
  }
  return RecordOf(table, columns);
}

SweepFile ReadSweep(const std::filesystem::path& path, const RecordColumns& columns,
                    const std::string& response) {
  return SweepOf(ReadCsvTable(path, {}, columns.encoding), columns, response);
}

SweepFile SweepOf(const CsvTable& table, const RecordColumns& columns,
                  const std::string& response) {
  const ColumnNames names(table);
  SweepFile sweep;
  sweep.lines = table.lines;
  sweep.notes = table.notes;
  std::vector<bool> taken(table.columns.size());
  const auto find = [&](Role role, const std::string& text) {
    Expression found = names.Read(text, RulesOf(role));
    if (found.terms.empty()) {
      if (const auto column = FindColumnOf(names, role, taken)) found.terms = {{*column, 1.0}};
    }
    if (!found.terms.empty()) taken[found.terms.front().column] = true;
    return found;
  };
  const auto is_chosen = [&](const std::string& text, Role role) {
    return !names.Read(text, RulesOf(role)).terms.empty();
  };
  Expression responses = find(Role::kResponse, response);
  Expression displacement;
  Expression force;
  if (!is_chosen(columns.force, Role::kForce))
    displacement = find(Role::kDisplacement, columns.displacement);
  if (!is_chosen(columns.displacement, Role::kDisplacement))
    force = find(Role::kForce, columns.force);
  if (responses.terms.empty()) {
    throw InputError(
        fmt::format("{}: no column of a stiffness or compliance is recognised: name it "
                    "with --response: {}",
                    table.file, names.Listing()));
  }
  if (displacement.terms.empty() == force.terms.empty()) {
    throw InputError(fmt::format(
        "{}: {} of the amplitude is recognised: name the one with --displacement or --force: {}",
        table.file, force.terms.empty() ? "no column" : "more than one column", names.Listing()));
  }
  sweep.over_force = displacement.terms.empty();
  const std::size_t of_response = responses.terms.front().column;
  const std::string stated =
      responses.unit.empty() ? names.UnitOf(of_response, "--response") : responses.unit;
  sweep.is_compliance =
      LengthUnit(stated.substr(0, stated.find('/'))).has_value() ||
      (stated.empty() && EvidenceOf(names.split(of_response).name).word.ends_with("compliance"));
  const auto read = [&](Role role, Expression& of) {
    const RoleRules& rules = RulesOf(role);
    const Unit unit = FindUnit(names, rules, of, sweep.notes);
    const std::size_t column = of.terms.front().column;
    std::vector<double> values;
    for (const double number : table.Numbers(column)) {
      values.push_back(unit.ToSi(of.terms.front().weight * number + of.offset));
      if (values.back() > 0 && std::isfinite(values.back())) continue;
      throw InputError(
          fmt::format("{}:{}:{}: {} in SI units must be > 0 in a sweep: remove the row", table.file,
                      table.lines[values.size() - 1], column + 1, values.back()));
    }
    return values;
  };
  sweep.amplitude = read(sweep.over_force ? Role::kForce : Role::kDisplacement,
                         sweep.over_force ? force : displacement);
  sweep.response = read(Role::kResponse, responses);
  return sweep;
}

std::vector<double> ReadDisplacementPath(const std::filesystem::path& path,
                                         const std::string& displacement) {
  return ReadPathColumn(ReadCsvTable(path), Role::kDisplacement, displacement);
}

LoadedPath ReadLoadedPath(const std::filesystem::path& path, const std::string& displacement,
                          const std::string& normal_load) {
  const CsvTable table = ReadCsvTable(path);
  return {ReadPathColumn(table, Role::kDisplacement, displacement),
          ReadPathColumn(table, Role::kNormalLoad, normal_load)};
}

ForcePath ReadForcePath(const std::filesystem::path& path, const std::string& force) {
  const CsvTable table = ReadCsvTable(path);
  return {ReadPathColumn(table, Role::kForce, force), table.lines};
}

}  // namespace mindahl::io
