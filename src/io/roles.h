#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/column_name.h"
#include "io/expression.h"
#include "mindahl/core/units.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// Holds what is asked of the columns of a role.
struct RoleRules {
  Role role;
  std::string_view name;  ///< "normal load"
  std::string_view option;
  std::string_view si_unit;
  std::optional<Unit> (*find_unit)(std::string_view);
  std::string (*unit_symbols)();
};
/// @param is_torsional  of an angle and a torque
const RoleRules& RulesOf(Role role, bool is_torsional = false);

/// The names and numbers of a table's columns, for choices and messages.
class ColumnNames {
 public:
  /// A column, with what is evidence of its role.
  struct Column {
    ColumnName name;
    Dimension dimension = Dimension::kNone;
    bool is_numeric = false;   ///< half of its rows or more have a number
    bool is_clock = false;     ///< its numbers are times of day
    bool is_constant = false;  ///< all numbers are the same
    bool is_monotone = false;  ///< only grows or only falls, as a clock or a counter does
    /// Both rises and falls by a good part of its range: noise does not, nor does a friction force
    /// along a single stroke. Half the range is what one cycle from the middle has.
    bool goes_to_and_fro = false;
  };
  explicit ColumnNames(const CsvTable& table);

  [[nodiscard]] std::size_t size() const { return columns_.size(); }
  const Column& operator[](std::size_t column) const { return columns_[column]; }
  [[nodiscard]] const CsvTable& table() const { return table_; }

  /// Returns the columns that the user gives for a role.
  /// @throws InputError for an unknown or ambiguous one
  [[nodiscard]] Expression Read(const std::string& text, const RoleRules& rules) const;
  /// Returns the column, from 0, that the user calls so.
  [[nodiscard]] std::size_t Chosen(const std::string& text, const RoleRules& rules) const;

  /// Returns the unit that the file states for a column, "" when it states none.
  /// @throws InputError where header and units row state two different units
  [[nodiscard]] std::string UnitOf(std::size_t column, std::string_view option) const;
  [[nodiscard]] bool StatesOneUnit(std::size_t column) const;
  /// Returns the name of a column, without its unit, where no other has the same; else its number.
  [[nodiscard]] std::string NameOf(std::size_t column) const;
  /// "'x [mm]' (column 2)", or "column 2" without a header.
  [[nodiscard]] std::string Label(std::size_t column) const;
  /// "'x' (column 1) and 'd' (column 2)".
  [[nodiscard]] std::string Labels(const std::vector<std::size_t>& columns) const;
  /// "the columns are 'x' (1), 'F' (2)".
  [[nodiscard]] std::string Listing() const;
  /// "file:line" of the header.
  [[nodiscard]] std::string Header() const;

 private:
  [[nodiscard]] std::optional<std::size_t> Named(std::string_view name,
                                                 const RoleRules& rules) const;

  const CsvTable& table_;
  std::vector<Column> columns_;
};

/// Finds the unit of a role's columns: as given, of the header, or SI with a note.
/// @throws InputError for a unit that is none of the role's, and for columns in several units
Unit FindUnit(const ColumnNames& names, const RoleRules& rules, const Expression& columns,
              std::vector<std::string>& notes);

/// The columns of a record; none where there is no such quantity.
struct Roles {
  bool is_torsional = false;
  Expression displacement, force, time, normal_load;
};

/// Assigns the columns of a record, as they are given, else by the evidence of unit, name and
/// numbers.
/// @throws InputError where evidence is missing or contradicts, with the columns and the option
Roles AssignRoles(const ColumnNames& names, const RecordColumns& columns,
                  std::vector<std::string>& notes);

/// Returns the column with the best evidence for a role; empty where none has any.
/// @param taken  columns that are something else
std::optional<std::size_t> FindColumnOf(const ColumnNames& names, Role role,
                                        const std::vector<bool>& taken);

}  // namespace mindahl::io
