#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/table.h"
#include "mindahl/core/units.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// Names what a column may be.
enum class Role { kDisplacement, kForce, kTime, kNormalLoad, kOther };

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

/// A column of a table with what is evidence of its role.
struct Column {
  // From the header: "Time [s]" has the name "Time" and the unit "s".
  std::string name = {};
  std::string unit = {};  // as written, perhaps in the units row; "" where the file states none
  std::optional<Dimension> dimension = {};  // of a unit that is known
  std::string_view word = {};               // the best of words.h in the name, with what it says
  Role role = Role::kOther;
  int rank = 0;
  bool is_angular = false;
  bool is_lesser = false;       // commanded, raw or a statistic
  bool is_ratio = false;        // without a unit: a coefficient of friction
  std::size_t other_words = 0;  // in the name
  // From the numbers in its rows:
  bool is_numeric = false;             // half of its rows or more have one
  bool is_clock = false;               // they are times of day
  double least = 0.0, greatest = 0.0;  // infinite the other way without any
  double first = 0.0;
  int trend = 0;  // 1 where it only grows, as a clock or a counter does; -1 where it only falls
  // Both rises and falls by a good part of its range: a noisy force along a single stroke does not.
  // Half the range is what one cycle from the middle has.
  bool goes_to_and_fro = false;

  /// True if its name has a word of that role.
  [[nodiscard]] bool names(Role other) const { return !word.empty() && role == other; }
  /// Returns whether it is an angle or a torque, or else a length or a force, by a unit or else
  /// the name; empty where neither says.
  /// @param given_unit  in place of its own, where there is one
  [[nodiscard]] std::optional<bool> IsAngular(std::string_view given_unit) const;
};

/// Reads what a header cell says:
///   x [um]   F (kN)   F [kN] left   a unit in brackets; at the end also a word that is none known
///   Position, mm   x / mm           any unit behind a comma or a slash
///   disp_mm   pos_mm_filtered       among the words a unit of what the name is
/// A factor, a range in another unit than the SI one and a word for a ratio make a unit that is
/// none: "mm x1000", "5 kN", "normalized".
Column ReadName(std::string_view header);

/// The text in brackets, or the cell itself: "[mm]", "(mm)" and "mm" are "mm".
std::string_view WithoutBrackets(std::string_view cell);

/// True for the symbol of a unit usual in such files (mm, N, V, bar...), and for a word in
/// brackets.
bool LooksLikeUnit(std::string_view cell);

/// Returns how many of the header cells have a word or a unit that is known.
std::size_t CountKnownWords(std::span<const std::string> cells);

/// Returns the dimension of a unit; none of one that is not known.
std::optional<Dimension> DimensionOf(std::string_view symbol);
/// True if a quantity of that dimension may have the role.
bool MayHaveRole(std::optional<Dimension> dimension, Role role);

/// The columns of a table, for choices and messages. A unit in the name and another below it make
/// one that is none.
class Columns : public std::vector<Column> {
 public:
  explicit Columns(const CsvTable& table);

  [[nodiscard]] const CsvTable& table() const { return table_; }
  /// Returns the column of a name, from 0; empty where there is none.
  /// @throws InputError where it is that of several
  [[nodiscard]] std::optional<std::size_t> Named(std::string_view name, Role role) const;
  /// Returns the place of one of them, from 0.
  [[nodiscard]] std::size_t IndexOf(const Column& column) const {
    return static_cast<std::size_t>(&column - data());
  }
  /// "'x [mm]' (column 2)", or "column 2" without a header.
  [[nodiscard]] std::string Label(std::size_t column) const;
  /// "the columns are 'x' (1), 'F' (2)".
  [[nodiscard]] std::string Listing() const;
  /// "file:line" of the header.
  [[nodiscard]] std::string Header() const;
  /// Refuses two columns for one role.
  [[noreturn]] void ThrowAmbiguous(Role role, std::size_t one, std::size_t other) const;

 private:
  /// Takes a friction without a unit beside a load for a coefficient, and beside a friction force
  /// or a coefficient what is called a load for the normal one.
  void FindLoadOfFriction();

  const CsvTable& table_;
};

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
Quantity ReadQuantity(const std::string& text, const Columns& columns, Role role);

/// Returns the column, from 0, that the user calls so.
std::size_t ReadCovariate(const std::string& text, const Columns& columns);

/// Returns the column with the best evidence for a role; none where none has any.
/// @param taken  columns that are none of the role's; none where it is empty
std::optional<std::size_t> BestColumn(const Columns& columns, Role role,
                                      const std::vector<bool>& taken = {});

/// Finds the unit of a quantity: as given, of the header, or, with a note, that of a stamp or SI.
/// @throws InputError for a unit that is none of the role's, and for columns in several units
void FindUnitOf(Quantity& quantity, const Columns& columns, bool is_torsional,
                std::vector<std::string>& notes);

/// Returns the quantities of a record, from displacement and force to time and normal load where
/// there are such: as they are given, else by the evidence of unit, name and numbers.
/// @throws InputError where evidence is missing or contradicts, with the columns and the option
std::vector<Quantity> AssignRoles(const Columns& columns, const RecordColumns& asked,
                                  std::vector<std::string>& notes);

}  // namespace mindahl::io
