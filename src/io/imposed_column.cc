#include <algorithm>
#include <array>
#include <utility>

#include "io/roles.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

std::vector<double> ImposedDisplacement(const CsvTable& table, const std::string& column) {
  const ColumnNames names(table);
  const std::vector<bool> taken(names.size());
  Expression columns = names.Read(column, Role::kDisplacement);
  if (columns.terms.empty()) {
    const bool first_is_another =
        std::ranges::any_of(std::array{Role::kTime, Role::kForce}, [&](Role other) {
          const Expression found = names.Find("", other, taken);
          return !found.terms.empty() && found.terms.front().column == 0;
        });
    if (first_is_another) columns.terms = names.Find("", Role::kDisplacement, taken).terms;
    if (columns.terms.empty()) columns.terms = {{0, 1.0}};
  }
  const auto dimension = columns.unit.empty() ? names[columns.terms.front().column].dimension
                                              : DimensionOf(columns.unit);
  const bool is_torsional = dimension == Dimension::kAngle || dimension == Dimension::kTorque;
  std::vector<std::string> notes;  // SI is the documented default here
  return names.InUnit(Role::kDisplacement, std::move(columns), is_torsional, notes).Numbers(table);
}

}  // namespace mindahl::io
