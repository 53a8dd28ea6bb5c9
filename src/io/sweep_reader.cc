#include <algorithm>
#include <utility>

#include "io/roles.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

SweepFile ReadSweep(const std::filesystem::path& path, const RecordColumns& columns,
                    const std::string& response) {
  const CsvTable table = ReadCsvTable(path, {}, columns.encoding);
  const ColumnNames names(table);
  SweepFile sweep;
  sweep.lines = table.lines;
  sweep.notes = table.notes;
  std::vector<bool> taken(names.size());
  const auto find = [&](Role role, const std::string& text) {
    Expression found = names.Find(text, role, taken);
    if (!found.terms.empty()) taken[found.terms.front().column] = true;
    return found;
  };
  const auto is_chosen = [&](Role role) {
    return !names.Read(AskedOf(columns, role), role).terms.empty();
  };
  Expression responses = find(Role::kResponse, response);
  Expression displacement;
  Expression force;
  if (!is_chosen(Role::kForce)) displacement = find(Role::kDisplacement, columns.displacement);
  if (!is_chosen(Role::kDisplacement)) force = find(Role::kForce, columns.force);
  if (responses.terms.empty()) {
    Refuse("{}: no column of a stiffness or compliance is recognised: name it with --response: {}",
           table.file, names.Listing());
  }
  if (displacement.terms.empty() == force.terms.empty()) {
    Refuse("{}: {} of the amplitude is recognised: name the one with --displacement or --force: {}",
           table.file, force.terms.empty() ? "no column" : "more than one column", names.Listing());
  }
  sweep.over_force = displacement.terms.empty();
  const std::size_t of_response = responses.terms.front().column;
  const std::string stated =
      responses.unit.empty() ? names.UnitOf(of_response, "--response") : responses.unit;
  sweep.is_compliance =
      LengthUnit(stated.substr(0, stated.find('/'))).has_value() ||
      (stated.empty() && names[of_response].name.evidence.word.ends_with("compliance"));
  const auto read = [&](Role role, Expression sum) {
    const Quantity quantity = names.InUnit(role, std::move(sum), false, sweep.notes);
    std::vector<double> values = quantity.Numbers(table);
    const auto bad = std::ranges::find_if(values, [](double value) { return !(value > 0); });
    if (bad != values.end()) {
      Refuse("{}:{}:{}: {} in SI units must be > 0 in a sweep: remove the row", table.file,
             table.lines[static_cast<std::size_t>(bad - values.begin())],
             quantity.first_column() + 1, *bad);
    }
    return values;
  };
  sweep.amplitude = sweep.over_force ? read(Role::kForce, std::move(force))
                                     : read(Role::kDisplacement, std::move(displacement));
  sweep.response = read(Role::kResponse, std::move(responses));
  return sweep;
}

std::vector<double> ImposedColumn(const CsvTable& table, Imposed quantity,
                                  const std::string& column) {
  const Role role = quantity == Imposed::kDisplacement ? Role::kDisplacement
                    : quantity == Imposed::kForce      ? Role::kForce
                                                       : Role::kNormalLoad;
  const ColumnNames names(table);
  const std::vector<bool> taken(names.size());
  Expression columns = names.Read(column, role);
  if (columns.terms.empty()) {
    const bool first_is_another = std::ranges::any_of(
        std::array{Role::kTime, Role::kForce, Role::kDisplacement}, [&](Role other) {
          const Expression found = names.Find("", other, taken);
          return other != role && !found.terms.empty() && found.terms.front().column == 0;
        });
    if (first_is_another) columns.terms = names.Find("", role, taken).terms;
    if (columns.terms.empty()) columns.terms = {{0, 1.0}};
  }
  const Dimension dimension = columns.unit.empty() ? names[columns.terms.front().column].dimension
                                                   : DimensionOfUnit(columns.unit);
  const bool is_torsional = dimension == Dimension::kAngle || dimension == Dimension::kTorque;
  std::vector<std::string> notes;  // SI is the documented default here
  return names.InUnit(role, std::move(columns), is_torsional && role != Role::kForce, notes)
      .Numbers(table);
}

}  // namespace mindahl::io
