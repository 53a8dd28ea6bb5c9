#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table.h"

namespace mindahl::io {

/// A quantity as a table gives it: the sum of weight·column and an offset, in a unit.
struct Quantity {
  struct Term {
    std::size_t column;  ///< from 0
    double weight = 1.0;
  };
  Role role;
  std::vector<Term> terms = {};  // none where only a unit is given
  double offset = -0.0;          ///< to which adding -0 makes -0
  bool is_scaled = false;        ///< a factor or an offset is given
  std::string given_unit = {};   // "" where none is given
  Unit unit = {};                // set by FindUnitOf()
  bool has_no_unit = false;      ///< the unit is assumed

  [[nodiscard]] std::size_t first_column() const { return terms.front().column; }
  /// True if it is a column as it is, or the magnitude of a load.
  [[nodiscard]] bool is_plain() const {
    return terms.size() == 1 && !is_scaled &&
           (role == Role::kNormalLoad || terms.front().weight == 1.0);
  }
  /// Returns its value in a row, in its unit.
  [[nodiscard]] double ValueIn(const CsvTable& table, std::size_t row) const {
    double value = offset;
    for (const auto& [column, weight] : terms) value += weight * table.columns[column].values[row];
    return value;
  }
};

/// Reads a text of RecordColumns. One that is a name as a whole is that column; in a sum, a column
/// is called by number behind '#'.
/// @throws InputError for an unknown or ambiguous one
Quantity ReadQuantity(const std::string& text, const CsvTable& table, Role role);

/// Returns the column, from 0, that the user calls so.
std::size_t ReadCovariate(const std::string& text, const CsvTable& table);

/// Returns the column with the best evidence for a role; none where none has any.
/// @param taken  columns that are none of the role's; none where it is empty
/// @param turns  whether a displacement is to be an angle, or a force a torque
/// @throws InputError where two have as much for a displacement or a force
std::optional<std::size_t> BestColumn(const CsvTable& table, Role role,
                                      const std::vector<bool>& taken = {},
                                      std::optional<bool> turns = {});

/// Finds the unit of a quantity: as given, of the header, or, with a note, that of a stamp or SI.
/// @throws InputError for a unit that is none of the role's, and for columns in several units
void FindUnitOf(Quantity& quantity, const CsvTable& table, bool is_torsional,
                std::vector<std::string>& notes);

/// Returns the quantities of a record, from displacement and force to time and normal load where
/// there are such: as they are given, else by the evidence of unit, name and numbers.
/// @throws InputError where evidence is missing or contradicts, with the columns and the option
std::vector<Quantity> AssignRoles(const CsvTable& table, const RecordColumns& asked,
                                  std::vector<std::string>& notes);

}  // namespace mindahl::io
