#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/column_name.h"
#include "io/source.h"
#include "mindahl/core/units.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// Holds what is asked of the columns of a role, and where they are in a record.
struct RoleRules {
  std::string_view name;  ///< "normal load"
  std::string_view option;
  Dimension linear, angular;  // of its units
  std::string RecordColumns::*given;
  ChosenColumn RecordFile::*chosen;
  std::vector<double> loop::Record::*values;
};
const RoleRules& RulesOf(Role role);

/// A quantity as a table gives it: the sum of weight·column and an offset, in a unit.
struct Quantity {
  struct Term {
    std::size_t column;  ///< from 0
    double weight;
  };
  Role role;
  std::vector<Term> terms = {};  // none where only a unit is given
  double offset = -0.0;          ///< to which adding -0 makes -0
  bool is_scaled = false;        ///< a factor or an offset is given
  std::string given_unit = {};   // "" where none is given
  Unit unit = {};                // set by ColumnNames::FindUnitOf()
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
  /// Returns its values in SI units, one a row.
  /// @throws InputError where one is missing
  [[nodiscard]] std::vector<double> Numbers(const CsvTable& table) const;
};

/// The names and numbers of a table's columns, for choices and messages.
class ColumnNames {
 public:
  /// A column, with what is evidence of its role; its unit may be of the units row.
  struct Column : ColumnName {
    std::optional<Dimension> dimension = {};
    bool is_numeric = false;             ///< half of its rows or more have a number
    bool is_clock = false;               ///< its numbers are times of day
    double least = 0.0, greatest = 0.0;  // numbers; infinite the other way without any
    int trend = 0;  ///< 1 where it only grows, as a clock or a counter does; -1 where it only falls
    /// Both rises and falls by a good part of its range: noise does not, nor does a friction force
    /// along a single stroke. Half the range is what one cycle from the middle has.
    bool goes_to_and_fro = false;
    double first = 0.0;  ///< number

    [[nodiscard]] double GreatestMagnitude() const { return std::max(-least, greatest); }
    /// Returns whether it is an angle or a torque, or else a length or a force, by a unit or else
    /// the name; empty where neither says.
    /// @param given_unit  in place of its own, where there is one
    [[nodiscard]] std::optional<bool> IsAngular(std::string_view given_unit) const;
  };
  explicit ColumnNames(const CsvTable& table);

  [[nodiscard]] std::size_t size() const { return columns_.size(); }
  const Column& operator[](std::size_t column) const { return columns_[column]; }
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  [[nodiscard]] const CsvTable& table() const { return table_; }

  /// Reads what an option says of a role's columns: a name or a number from 1, "Fx", "3"; with a
  /// unit in brackets, "3 [kN]", or that alone, "[kN]"; a sum of columns with factors and an
  /// offset, "raw*0.0123-4.5 [N]", "cell1+cell2", "#4-#3". A text that is a name as a whole is that
  /// column; in a sum, a column is called by number behind '#'.
  /// @throws InputError for an unknown or ambiguous one
  [[nodiscard]] Quantity Read(const std::string& text, Role role) const;
  /// Returns the column of a name, from 0; empty where there is none.
  /// @throws InputError where it is that of several
  [[nodiscard]] std::optional<std::size_t> Named(std::string_view name, Role role) const;
  /// Returns the column with the best evidence; none where none has any.
  /// @param taken  columns that are none of the role's; none where it is empty
  [[nodiscard]] std::optional<std::size_t> Best(Role role,
                                                const std::vector<bool>& taken = {}) const;
  /// Returns the column, from 0, that the user calls so.
  [[nodiscard]] std::size_t Chosen(const std::string& text, Role role) const;
  /// Finds the unit of a quantity: as given, of the header, or, with a note, that of a stamp or SI.
  /// @throws InputError for a unit that is none of the role's, and for columns in several units
  void FindUnitOf(Quantity& quantity, bool is_torsional, std::vector<std::string>& notes) const;
  /// Lets a time count from the first stamp since 1970, or the first time of day, with a note.
  void SetOriginOf(Quantity& time, std::vector<std::string>& notes) const;

  /// Returns the unit that the file states for a column, "" when it states none.
  /// @throws InputError where header and units row state two different units
  [[nodiscard]] std::string UnitOf(std::size_t column, Role role) const;
  /// Returns the name of a column, without its unit, where no other has the same; else its number.
  [[nodiscard]] std::string NameOf(std::size_t column) const;
  /// "'x [mm]' (column 2)", or "column 2" without a header.
  [[nodiscard]] std::string Label(std::size_t column) const;
  /// "the columns are 'x' (1), 'F' (2)".
  [[nodiscard]] std::string Listing() const;
  /// "file:line" of the header.
  [[nodiscard]] std::string Header() const;
  /// Refuses columns, "'x' (column 1) and 'd' (column 2) may each be the displacement: give …".
  [[noreturn]] void ThrowAmbiguous(Role role, const std::vector<std::size_t>& columns) const;

 private:
  const CsvTable& table_;
  std::vector<Column> columns_;
};

/// Returns the quantities of a record, from displacement and force to time and normal load where
/// there are such: as they are given, else by the evidence of unit, name and numbers.
/// @throws InputError where evidence is missing or contradicts, with the columns and the option
std::vector<Quantity> AssignRoles(const ColumnNames& names, const RecordColumns& columns,
                                  std::vector<std::string>& notes);

}  // namespace mindahl::io
