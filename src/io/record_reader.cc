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

/// Returns the numbers of a table's column in the rows of some lines.
std::vector<double> AtLines(const CsvTable& table, std::size_t column,
                            const std::vector<std::size_t>& lines) {
  const std::vector<double>& values = table.columns[column].values;
  std::vector<double> kept;
  kept.reserve(lines.size());
  for (std::size_t row = 0; row < values.size() && kept.size() < lines.size(); ++row) {
    if (table.lines[row] == lines[kept.size()]) kept.push_back(values[row]);
  }
  return kept;
}

/// Reads the columns chosen in addition to displacement and force, then some of the others: those
/// with a number in every row, and not the same in all.
void AddCovariates(const ColumnNames& names, const std::vector<std::string>& choices,
                   RecordFile& file) {
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
    std::vector<double> values = AtLines(table, column, file.lines);
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
    std::vector<double> values = AtLines(table, column, file.lines);
    const bool changes = std::ranges::adjacent_find(values, std::not_equal_to<>()) != values.end();
    if (!changes || !std::ranges::all_of(values, IsNumber)) continue;
    add(column, names.NameOf(column), std::move(values));
    --left;
  }
}

/// Returns the columns that are given for a role, else the one that is recognised; none where there
/// is none.
Expression FindColumns(const ColumnNames& names, Role role, const std::string& text,
                       const std::vector<bool>& taken) {
  Expression columns = names.Read(text, RulesOf(role));
  const std::optional<std::size_t> found =
      columns.terms.empty() ? FindColumnOf(names, role, taken) : std::nullopt;
  if (found) columns.terms = {{*found, 1.0}};
  return columns;
}

/// Returns the numbers of a role's columns in SI units.
/// @throws InputError where one is missing or too large
std::vector<double> NumbersOf(const ColumnNames& names, const RoleRules& rules,
                              const Expression& columns, std::vector<std::string>& notes) {
  const CsvTable& table = names.table();
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

/// Returns the times of a table, by which another is joined to it; none where it has none.
std::vector<double> TimesOf(const CsvTable& table, const std::string& given) {
  const ColumnNames names(table);
  Expression time = FindColumns(names, Role::kTime, given, std::vector<bool>(names.size()));
  if (time.terms.empty()) return {};
  if (names[time.terms.front().column].is_clock) time.unit = "s";
  std::vector<std::string> notes;
  return NumbersOf(names, RulesOf(Role::kTime), time, notes);
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

}  // namespace

RecordFile RecordOf(const CsvTable& table, const RecordColumns& columns) {
  RecordBuilder builder(table, columns);
  Samples samples;
  std::string fault = builder.Add(table, samples);
  if (fault.empty()) fault = builder.TooManyLeftOut();
  RecordFile& file = builder.file();
  file.left_out = builder.left_out();
  if (fault.empty() && samples.lines.empty()) fault = file.left_out.fault;
  if (!fault.empty()) throw InputError(fault);
  if (file.left_out.count > 0) {
    file.notes.push_back(fmt::format(
        "{}: {} of {} rows have no number in a column that is used and are left out, the first in "
        "line {}",
        table.file, file.left_out.count, table.rows(), file.left_out.first_line));
  }
  file.lines = std::move(samples.lines);
  file.record = std::move(samples);
  AddCovariates(ColumnNames(table), columns.covariates, file);
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

std::vector<double> ImposedColumn(const CsvTable& table, Imposed quantity,
                                  const std::string& column) {
  const Role role = quantity == Imposed::kDisplacement ? Role::kDisplacement
                    : quantity == Imposed::kForce      ? Role::kForce
                                                       : Role::kNormalLoad;
  const ColumnNames names(table);
  const std::vector<bool> taken(names.size());
  Expression columns = names.Read(column, RulesOf(role));
  if (columns.terms.empty()) {
    const auto is_first = [&](Role other) {
      return other != role && FindColumnOf(names, other, taken) == std::size_t{0};
    };
    const bool first_is_another =
        is_first(Role::kTime) || is_first(Role::kForce) || is_first(Role::kDisplacement);
    const auto found = first_is_another ? FindColumnOf(names, role, taken) : std::nullopt;
    columns.terms = {{found.value_or(0), 1.0}};
  }
  const Dimension dimension = columns.unit.empty() ? names[columns.terms.front().column].dimension
                                                   : DimensionOfUnit(columns.unit);
  const bool is_torsional = dimension == Dimension::kAngle || dimension == Dimension::kTorque;
  std::vector<std::string> notes;  // SI is the documented default here
  return NumbersOf(names, RulesOf(role, is_torsional && role != Role::kForce), columns, notes);
}

}  // namespace mindahl::io
