#pragma once

#include <cstddef>
#include <optional>
#include <string>
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

/// Returns the 0-based index of the column that `text` names.
std::size_t ReadCovariate(const std::string& text, const CsvTable& table);

/// Returns the displacement that the user calls so; without a name that of the first column or,
/// where that is a time or a force, the one of the best evidence.
Quantity ReadImposed(const std::string& text, const CsvTable& table);

/// Returns the column of the best evidence of a time.
std::optional<std::size_t> BestTime(const CsvTable& table);

/// Returns the quantities of a record, from displacement and force to time and normal load where
/// there are such: as they are given, else by the evidence of unit, name and numbers.
/// @throws InputError where evidence is missing or contradicts, with the columns and the option
std::vector<Quantity> AssignRoles(const CsvTable& table, const RecordColumns& asked,
                                  std::vector<std::string>& notes);

}  // namespace mindahl::io
