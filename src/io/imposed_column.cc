#include <algorithm>
#include <array>
#include <utility>

#include "io/roles.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

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
