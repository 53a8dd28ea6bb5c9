#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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
  // From the header cell: "Time [s]" has the name "Time" and the unit "s".
  std::string header = {};  // as written, "" without one
  std::string name = {};
  std::string unit = {};  // as written, perhaps in the units row; "" where the file states none
  std::optional<Dimension> dimension = {};  // of a unit that is known
  std::string_view word = {};               // the best of words.h in the name, with what it says
  Role role = Role::kOther;
  int rank = 0;
  bool is_angular = false;
  bool is_lesser = false;       // commanded, raw or a statistic
  std::size_t other_words = 0;  // in the name
  // One a row; none in a column of text. NaN where the cell is empty or holds a mark of a missing
  // number, infinite where it or its row is at fault otherwise.
  std::vector<double> values = {};
  bool is_clock = false;  // they are times of day [s]
  // Say of the first NaN, and of the first infinite value: "file:line:column: …".
  std::string missing = {}, broken = {};
  // From the values, by Observe():
  bool is_numeric = false;             // half of them or more are numbers
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
/// A factor, a range in another unit than the SI one, and another unit below the name make one that
/// is none: "mm x1000", "5 kN", "mm or um".
/// @param below  the cell of the units row
Column ReadName(std::string_view header, std::string_view below = {});

/// True for the symbol of a unit usual in such files (mm, N, V, bar...) and a word in brackets.
bool LooksLikeUnit(std::string_view cell);

/// True for the unit of a sensor's signal (V, counts...), which a gain makes another.
bool IsOfSignal(std::string_view symbol);

/// True if a quantity of that dimension may have the role.
bool MayHaveRole(std::optional<Dimension> dimension, Role role);

/// Stands for the unit of a coefficient, which has none.
inline constexpr std::string_view kRatioUnit = "ratio";

/// Describes how the values of columns behave. A friction without a unit beside a load is a ratio;
/// a load beside a friction force, or of one sign beside a ratio, is the normal one.
void Observe(std::vector<Column>& columns);

}  // namespace mindahl::io
